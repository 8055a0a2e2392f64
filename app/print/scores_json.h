// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "thermorig/estimators/live/scores.h"

namespace thermorig::app {

/// The figures of the screen as docs/live_messages.md names them: every digit of them, null where unknown.
nlohmann::json scores_json(const live::LiveScores& scores);

}  // namespace thermorig::app
