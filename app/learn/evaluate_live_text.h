// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "thermorig/core/raw_recording.h"
#include "thermorig/estimators/live/finalised_rows.h"
#include "thermorig/estimators/live/scores.h"

namespace thermorig::app {

/// A live run that was kept: the screen's last figures, and what they become with the finalised labels.
struct LiveEvaluation {
  std::string session;  // path
  RecordingHeader header;
  live::LiveScores screen;
  live::FinalisedRows finalised;
  live::LiveScores finalised_scores;
};

std::string live_text(const LiveEvaluation& evaluated);
nlohmann::json live_json(const LiveEvaluation& evaluated);

}  // namespace thermorig::app
