// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "thermorig/rig/sweep/plan.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::app {

/// Everything that `inspect` says of a session: what it is, streams, frames by speed, reasons, verdict.
std::string text_of(const std::filesystem::path& path, const session::Session& session,
                    const session::Quality& quality);
nlohmann::json inspected_json(const std::filesystem::path& path, const session::Session& session,
                              const session::Quality& quality);

/// What a command tells of a session that it made or looked at: frames, those in legs, those that are valid,
/// verdict.
nlohmann::json quality_json(const session::Quality& quality);
std::string valid_frames_text(const session::Quality& quality);

/// Names attributes that are not as they were written; empty if there is none.
std::string altered_text(const std::vector<std::string>& altered);

/// Speeds of a plan with fewer frames than it asks for, those that were never driven included.
struct ShortSpeeds {
  std::size_t planned = 0;  // different speeds in the plan
  std::size_t count = 0;    // of them short
  std::string text;         // "+7.5 deg/s (12 of 57)", the worst few
};
ShortSpeeds short_speeds(const session::Quality& quality, const rig::SweepPlan& plan);

/// What rewriting a session leaves out of its file, and why.
std::string left_out_text(const std::vector<std::string>& left_out);

}  // namespace thermorig::app
