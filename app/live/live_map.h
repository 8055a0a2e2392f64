// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "thermorig/core/profile.h"
#include "thermorig/core/raw_recording.h"
#include "thermorig/estimators/odometer/map.h"

namespace thermorig::app {

/// The file of --map over one run: begun with where it is there, written where the run ends well. A map that
/// was not recognised stays as it is.
class LiveMap {
 public:
  /// An empty path: without one. Throws Error(not_a_session) for a file that is no sound map,
  /// Error(bad_usage) for one of another lens, of simulated surroundings on a real rig or the other way
  /// round, and for a folder that is not there.
  LiveMap(std::filesystem::path path, const CameraProfile& camera, bool simulated);

  std::shared_ptr<const odometer::Map> begun_with() const { return map_; }

  /// What there is to say at first, and since the last call. Nothing mostly.
  std::optional<std::string> news(odometer::MapUse use);

  /// Writes the run's map over the file, and says so, or why not. Nothing without a path. Throws
  /// Error(storage).
  std::optional<std::string> write(const std::optional<odometer::Map>& map, odometer::MapUse use,
                                   const RecordingHeader& header) const;

 private:
  std::string opening() const;

  std::filesystem::path path_;
  std::shared_ptr<const odometer::Map> map_;
  std::string origin_;  // where the map is from, in words
  std::optional<odometer::MapUse> told_;
};

}  // namespace thermorig::app
