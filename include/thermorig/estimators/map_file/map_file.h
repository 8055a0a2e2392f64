// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "thermorig/core/profile.h"
#include "thermorig/estimators/odometer/map.h"
#include "thermorig/io/files/replaced_file.h"

namespace thermorig::map_file {

/// A map of the surroundings, and the session that it is of.
struct StoredMap {
  bool simulated = false;
  std::string environment, rig;  // names; of a file they are hostile
  std::string made_utc;          // when the session began
  std::string creator;           // "thermorig 0.1.0"
  odometer::Map map;
};

/// Longest name that is kept, in bytes: what is longer is cut.
inline constexpr std::size_t name_bytes_max = 255;

inline constexpr std::size_t file_bytes_max = 200'000;  // more than the largest map has

/// "THRMAP01", names, lens, map, CRC-32 of all before it; little-endian. "THRMAP02" where the lens distorts,
/// is tilted or rolled.
std::string bytes_of(const StoredMap& stored);

/// Throws Error(not_a_session) for what is no map, damaged, or has a number that no map has. `where`: the
/// file.
StoredMap map_from(std::string_view bytes, const std::string& where);

/// Does a regular file begin as a map's does, of whatever version?
bool is_map(const std::filesystem::path& path);

/// Throws Error(not_a_session), or Error(no_permission) for what may not be read.
StoredMap read_map(const std::filesystem::path& path);

/// The file of a map that will be written, anew or for the first time.
files::ReplacedFile replaced_map(const std::filesystem::path& path);

/// Into a part, which gets its name: the whole file or nothing of it. Where another program has written one
/// meanwhile: beside it, under the first name that is free, such as kitchen-2.map. Returns where it is.
/// Throws Error(storage).
std::filesystem::path write_map(files::PartFile& part, const StoredMap& stored);

/// Throws Error(bad_usage) for a map of another lens than the camera's, or of another order of its columns.
void require_lens(const odometer::Map& map, const CameraProfile& camera, const std::string& where);

/// Share of the surroundings that were seen once at least.
double seen_share(const odometer::Map& map);

}  // namespace thermorig::map_file
