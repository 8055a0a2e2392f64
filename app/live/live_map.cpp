// SPDX-License-Identifier: MIT
#include "live_map.h"

#include <fmt/format.h>

#include <utility>

#include "print/map_text.h"
#include "thermorig/core/error.h"
#include "thermorig/core/printable.h"

namespace thermorig::app {

namespace {

namespace fs = std::filesystem;

constexpr const char* name_another =
    "give --map the name of a file that does not exist: a new map is written there at the end";

void require_folder(const fs::path& path) {
  std::error_code hidden;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (fs::is_directory(folder, hidden)) return;
  throw Error(ExitCode::bad_usage, "the folder of the map is not there", path.string(),
              "mkdir -p " + folder.string());
}

map_file::StoredMap read_map(const fs::path& path) {
  try {
    return map_file::read_map(path);
  } catch (const Error& error) {
    if (error.code() != ExitCode::not_a_session) throw;
    throw Error(error.code(), error.what_happened(), error.where(), name_another);
  }
}

void require_same_kind(const map_file::StoredMap& stored, bool simulated, const fs::path& path) {
  if (stored.simulated == simulated) return;
  throw Error(ExitCode::bad_usage,
              fmt::format("the map is of {} surroundings, and this rig is {}",
                          stored.simulated ? "simulated" : "real", simulated ? "simulated" : "real"),
              path.string(), name_another);
}

std::string how_to_make_again(const fs::path& map, const fs::path& session) {
  if (session.empty()) return "this run's map is lost; --record keeps a session that can rebuild it";
  return fmt::format("then thermorig live --replay {} --speed max --map {} makes the map again",
                     shell_word(session.string()), shell_word(map.string()));
}

}  // namespace

LiveMap::LiveMap(fs::path path, const CameraProfile& camera, bool simulated) : path_(std::move(path)) {
  if (path_.empty()) return;
  files::ReplacedFile old = map_file::replaced_map(path_);
  require_folder(old.path());
  if (old.exists()) begin_with_file(camera, simulated);
  // Before anything moves: a run whose map cannot be kept would be in vain.
  part_ = std::make_unique<files::PartFile>(std::move(old));
  part_->reserve(map_file::file_bytes_max);
}

void LiveMap::begin_with_file(const CameraProfile& camera, bool simulated) {
  map_file::StoredMap stored = read_map(path_);
  require_same_kind(stored, simulated, path_);
  map_file::require_lens(stored.map, camera, path_.string());
  origin_ = origin_text(stored);
  map_ = std::make_shared<odometer::Map>(std::move(stored.map));
}

std::string LiveMap::opening() const {
  if (!map_) return fmt::format("map {}: new; written at the end", path_.string());
  return fmt::format("map {}: {}; locating the camera in it", path_.string(), origin_);
}

std::optional<std::string> LiveMap::news(odometer::MapUse use) {
  if (path_.empty() || told_ == use) return std::nullopt;
  const bool is_first = !told_;
  told_ = use;
  if (is_first) return opening();
  if (use == odometer::MapUse::found)
    return fmt::format("map {}: recognised; headings are since its origin", path_.string());
  return fmt::format(
      "map {}: the images do not fit it; a new map was begun, and the file is unchanged (another --map saves "
      "the new one)",
      path_.string());
}

std::optional<std::string> LiveMap::write(const std::optional<odometer::Map>& map, odometer::MapUse use,
                                          const RecordingHeader& header, const fs::path& session) {
  if (path_.empty()) return std::nullopt;
  const bool is_other = map_ && use != odometer::MapUse::found;
  if (is_other) return fmt::format("map {}: room not recognised; map unchanged", path_.string());
  if (!map)
    return fmt::format(
        "map {}: not written: the odometer has no reliable map yet (it needs half a minute of motion)",
        path_.string());
  return written_text(kept_at({.simulated = header.simulated,
                               .environment = header.environment,
                               .rig = header.profile.name,
                               .made_utc = header.start_time_utc,
                               .creator = header.creator,
                               .map = *map},
                              session),
                      map_file::seen_share(*map));
}

std::string LiveMap::written_text(const fs::path& written, double seen_share) const {
  const std::string share = fmt::format("with {:.0f} % of the surroundings", 100.0 * seen_share);
  if (written == part_->path()) return fmt::format("map {}: written, {}", path_.string(), share);
  return fmt::format(
      "map {0}: another program wrote it meanwhile, and it stays as it is; this run's map is in {1}, {2} "
      "(what both are: thermorig inspect {0} {1})",
      path_.string(), written.string(), share);
}

fs::path LiveMap::kept_at(const map_file::StoredMap& stored, const fs::path& session) {
  try {
    return map_file::write_map(*part_, stored);
  } catch (const Error& error) {
    throw Error(error.code(), error.what_happened(), path_.string(),
                error.advice() + "; " + how_to_make_again(path_, session));
  }
}

}  // namespace thermorig::app
