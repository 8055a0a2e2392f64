// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "thermorig/estimators/map_file/map_file.h"

namespace thermorig::app {

/// "93 % of the surroundings, kitchen, SIMULATED, of 2026-11-24T03:49:01Z".
std::string origin_text(const map_file::StoredMap& stored);

/// What `inspect` says of a map's file.
std::string map_text(const std::filesystem::path& path, const map_file::StoredMap& stored);
nlohmann::json map_json(const std::filesystem::path& path, const map_file::StoredMap& stored);

}  // namespace thermorig::app
