// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json.hpp>

#include "thermorig/core/profile.h"

namespace thermorig::recording_header {

/// An object of tables, as in the TOML file: keys are the fields' names.
nlohmann::json profile_to_json(const RigProfile& profile);

/// The inverse, of that form or of the one before session format 2.0. Keys that are missing keep their
/// standard value, unknown ones are ignored. Throws nlohmann::json::exception or std::out_of_range.
RigProfile profile_from_json(const nlohmann::json& in);

}  // namespace thermorig::recording_header
