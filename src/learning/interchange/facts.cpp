// SPDX-License-Identifier: MIT
#include "facts.h"

#include <nlohmann/json.hpp>

namespace thermorig::interchange {

nlohmann::json facts_of(const session::Session& session) {
  const RecordingHeader& header = session.raw.header;
  return {{"environment", header.environment},
          {"acquisition", header.acquisition},
          {"uuid", header.uuid},
          {"start_time", header.start_time_utc},
          {"plan", header.plan_name},
          {"simulated", header.simulated},
          {"simulation", header.simulation},
          {"licence", header.licence},
          {"creator", header.creator},
          {"verdict", session::quality_of(session).verdict},
          {"camera_mirrored", header.profile.camera.mirrored}};
}

std::uint64_t unix_ns(const RecordingHeader& header, HostTime time) {
  return static_cast<std::uint64_t>(to_ns(time)) + static_cast<std::uint64_t>(header.realtime_offset_ns);
}

}  // namespace thermorig::interchange
