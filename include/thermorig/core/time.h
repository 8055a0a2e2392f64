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

/// A duration in seconds, as the rest of the program counts it.
constexpr double to_s(HostDuration duration) {
  return static_cast<double>(duration.count()) * 1e-9;
}

/// Seconds to the nearest nanosecond.
constexpr HostDuration from_s(double seconds) {
  return HostDuration(static_cast<std::int64_t>(seconds * 1e9 + (seconds < 0 ? -0.5 : 0.5)));
}

}  // namespace thermorig
