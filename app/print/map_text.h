// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "thermorig/core/raw_recording.h"
#include "thermorig/estimators/map_file/map_file.h"

namespace thermorig::app {

/// "93 % of the surroundings, kitchen, SIMULATED, of 2026-11-24T03:49:01Z".
std::string origin_text(const map_file::StoredMap& stored);

/// What an odometer has found of the camera's rows, as an event of a live run:
/// "camera rows: read all at once, margin 87 (difference of log-likelihoods)".
std::string rows_text(const odometer::FoundRows& rows);
/// The newest such event, without its first words; empty: none of these is one.
std::string rows_told(std::span<const RecordingEvent> events);

/// What `inspect` says of a map's file.
std::string map_text(const std::filesystem::path& path, const map_file::StoredMap& stored);
nlohmann::json map_json(const std::filesystem::path& path, const map_file::StoredMap& stored);

}  // namespace thermorig::app
