// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "thermorig/learning/training/run_folder.h"

namespace thermorig::training {

/// All that `run.json` holds.
nlohmann::json to_json(const RunDescription& description);

/// What a `run.json` says, no deeper than such a file ever is; nothing if it is not JSON.
std::optional<nlohmann::json> description_from(std::string_view text);

/// One line of `metrics.ndjson`.
nlohmann::json to_json(const EpochReport& report, const TrainingConfig& config);

/// What differs between two descriptions, in words: "epochs (20, now 40)"; empty if nothing does.
std::string differences(const nlohmann::json& then, const nlohmann::json& now);

}  // namespace thermorig::training
