// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "thermorig/storage/session/session.h"

namespace thermorig::interchange {

/// What a file that a session became should still say of it: which recording, by what rig, how good.
nlohmann::json facts_of(const session::Session& session);

inline constexpr std::uint64_t second_ns = 1'000'000'000;

/// A time of the host's clock as Unix time in nanoseconds. What no recording can hold goes round.
std::uint64_t unix_ns(const RecordingHeader& header, HostTime time);

/// Whether something measured the shaft.
inline bool has_measured_shaft(const RawRecording& raw) {
  return !raw.header.shaft_sensor.empty();
}

}  // namespace thermorig::interchange
