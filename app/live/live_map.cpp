// SPDX-License-Identifier: MIT
#include "live_map.h"

#include <fmt/format.h>

#include <utility>

#include "print/map_text.h"
#include "thermorig/core/error.h"
#include "thermorig/estimators/map_file/map_file.h"

namespace thermorig::app {

namespace {

namespace fs = std::filesystem;

void require_folder(const fs::path& path) {
  std::error_code hidden;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (fs::is_directory(folder, hidden)) return;
  throw Error(ExitCode::bad_usage, "the folder of the map is not there", path.string(),
              "mkdir -p " + folder.string());
}

void require_same_kind(const map_file::StoredMap& stored, bool simulated, const fs::path& path) {
  if (stored.simulated == simulated) return;
  throw Error(ExitCode::bad_usage,
              fmt::format("the map is of {} surroundings, and this rig is {}",
                          stored.simulated ? "simulated" : "real", simulated ? "simulated" : "real"),
              path.string(), "name another file: what there is not yet is made");
}

}  // namespace

LiveMap::LiveMap(fs::path path, const CameraProfile& camera, bool simulated) : path_(std::move(path)) {
  if (path_.empty()) return;
  require_folder(path_);
  std::error_code hidden;  // what cannot be looked at is refused when it is read
  if (fs::status(path_, hidden).type() == fs::file_type::not_found) return;
  map_file::StoredMap stored = map_file::read_map(path_);
  require_same_kind(stored, simulated, path_);
  map_file::require_lens(stored.map, camera, path_.string());
  origin_ = origin_text(stored);
  map_ = std::make_shared<odometer::Map>(std::move(stored.map));
}

std::string LiveMap::opening() const {
  if (!map_) return fmt::format("map {}: there is none yet; it is written at the end", path_.string());
  return fmt::format("map {}: {}; where the camera looks in it is searched for", path_.string(), origin_);
}

std::optional<std::string> LiveMap::news(odometer::MapUse use) {
  if (path_.empty() || told_ == use) return std::nullopt;
  const bool is_first = !told_;
  told_ = use;
  if (is_first) return opening();
  if (use == odometer::MapUse::found)
    return fmt::format("map {}: recognised; headings are since its origin", path_.string());
  return fmt::format(
      "map {}: what the camera shows does not fit it; a new map is begun, and the file stays "
      "as it is (another --map keeps the new one)",
      path_.string());
}

std::optional<std::string> LiveMap::write(const std::optional<odometer::Map>& map, odometer::MapUse use,
                                          const RecordingHeader& header) const {
  if (path_.empty()) return std::nullopt;
  const bool is_other = map_ && use != odometer::MapUse::found;
  if (is_other) return fmt::format("map {}: it was not recognised, and stays as it is", path_.string());
  if (!map)
    return fmt::format(
        "map {}: not written: the odometer has none that it trusts (it takes half a minute of motion to one)",
        path_.string());
  map_file::write_map(path_, {.simulated = header.simulated,
                              .environment = header.environment,
                              .rig = header.profile.name,
                              .made_utc = header.start_time_utc,
                              .creator = header.creator,
                              .map = *map});
  return fmt::format("map {}: written, with {:.0f} % of the surroundings", path_.string(),
                     100.0 * map_file::seen_share(*map));
}

}  // namespace thermorig::app
