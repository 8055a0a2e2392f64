// SPDX-License-Identifier: MIT
#include "facts.h"

#include <nlohmann/json.hpp>

#include "thermorig/learning/interchange/table.h"
#include "thermorig/storage/session/annotations.h"

namespace thermorig::interchange {

nlohmann::json facts_of(const session::Session& session) {
  const RecordingHeader& header = session.raw.header;
  const session::Place place = session::place_of(session);
  return {{"environment", place.environment},
          {"acquisition", place.acquisition},
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

bool has_unix_times(const RawRecording& raw) {
  for (const HostTime time : {raw.header.time_reference, raw.end_time}) {
    std::int64_t unix_ns = 0;
    if (__builtin_add_overflow(to_ns(time), raw.header.realtime_offset_ns, &unix_ns) || unix_ns < 0)
      return false;
  }
  return true;
}

std::uint64_t unix_ns(const RecordingHeader& header, HostTime time) {
  return static_cast<std::uint64_t>(to_ns(time)) + static_cast<std::uint64_t>(header.realtime_offset_ns);
}

}  // namespace thermorig::interchange
