// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "thermorig/core/profile.h"
#include "thermorig/core/raw_recording.h"
#include "thermorig/estimators/map_file/map_file.h"

namespace thermorig::app {

/// The file of --map over one run: begun with where it is there, written where the run ends well. A map that
/// was not recognised stays as it is.
class LiveMap {
 public:
  /// An empty path: without one. Throws Error(not_a_session) for a file that is no sound map,
  /// Error(no_permission) for one that may not be read, Error(storage) where none could be written,
  /// Error(bad_usage) for one of another lens, of simulated surroundings on a real rig or the other way
  /// round, and for a folder that is not there.
  LiveMap(std::filesystem::path path, const CameraProfile& camera, bool simulated);

  std::shared_ptr<const odometer::Map> begun_with() const { return map_; }

  /// What there is to say at first, and since the last call. Nothing mostly.
  std::optional<std::string> news(odometer::MapUse use);

  /// Writes the run's map over the file, or beside it if it is not the one of the beginning any more, and
  /// says so, or why not. Nothing without a path. `session`: that of the run, empty if none is kept. Throws
  /// Error(storage), which says how to make the map again.
  std::optional<std::string> write(const std::optional<odometer::Map>& map, odometer::MapUse use,
                                   const RecordingHeader& header, const std::filesystem::path& session);

 private:
  void begin_with_file(const CameraProfile& camera, bool simulated);
  std::string opening() const;
  std::string written_text(const std::filesystem::path& written, double seen_share) const;
  /// Writes it; returns where.
  std::filesystem::path kept_at(const map_file::StoredMap& stored, const std::filesystem::path& session);

  std::filesystem::path path_;             // as it was given
  std::unique_ptr<files::PartFile> part_;  // its room is taken before the run
  std::shared_ptr<const odometer::Map> map_;
  std::string origin_;  // where the map is from, in words
  std::optional<odometer::MapUse> told_;
};

}  // namespace thermorig::app
