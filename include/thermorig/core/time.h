// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>
#include <ratio>

namespace thermorig {

/// The host's steady clock (CLOCK_MONOTONIC) in nanoseconds. It has no now(): time is an argument everywhere
/// except in `io`, which reads the clock. In virtual time the simulator makes the values.
struct HostClock {
  using rep = std::int64_t;
  using period = std::nano;
  using duration = std::chrono::duration<rep, period>;
  using time_point = std::chrono::time_point<HostClock>;
  static constexpr bool is_steady = true;
};

/// The servo micro-controller's clock in microseconds since its reset, unwrapped to 64 bits.
struct ServoClock {
  using rep = std::int64_t;
  using period = std::micro;
  using duration = std::chrono::duration<rep, period>;
  using time_point = std::chrono::time_point<ServoClock>;
  static constexpr bool is_steady = true;
};

using HostTime = HostClock::time_point;
using HostDuration = HostClock::duration;
using ServoTime = ServoClock::time_point;

constexpr HostTime host_time_ns(std::int64_t ns) {
  return HostTime(HostDuration(ns));
}
constexpr std::int64_t to_ns(HostTime time) {
  return time.time_since_epoch().count();
}

/// No host's clock stands further from its zero, and no time of a recording further from its reference, in
/// seconds: 31.7 years. No sum or difference of two such times leaves the clock's range.
inline constexpr double farthest_time_s = 1e9;

/// A duration in seconds, as the rest of the program counts it.
constexpr double to_s(HostDuration duration) {
  return static_cast<double>(duration.count()) * 1e-9;
}

/// Seconds to the nearest nanosecond. What is longer than 127 years is as long as that, so that a sum
/// with another such duration is one; what is not a number is none.
constexpr HostDuration from_s(double seconds) {
  constexpr double most_s = 4e9;
  if (seconds != seconds) return HostDuration{};
  const double within_s = seconds < -most_s ? -most_s : seconds > most_s ? most_s : seconds;
  return HostDuration(static_cast<std::int64_t>(within_s * 1e9 + (within_s < 0 ? -0.5 : 0.5)));
}

/// Whether a recording can count from that time of the host's clock.
constexpr bool is_reference(HostTime time) {
  constexpr HostTime farthest(from_s(farthest_time_s));
  return time >= -farthest.time_since_epoch() + HostTime{} && time <= farthest;
}

/// Whether `time` can be one of a recording that counts from `reference`, for which is_reference() holds.
constexpr bool is_of_recording(HostTime time, HostTime reference) {
  constexpr HostDuration farthest = from_s(farthest_time_s);
  return time >= reference - farthest && time <= reference + farthest;
}

}  // namespace thermorig
