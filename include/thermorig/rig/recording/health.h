// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "thermorig/core/time.h"
#include "thermorig/sensors/wire/counters.h"

namespace thermorig::rig {

/// How one device does: a line of the live display.
struct DeviceHealth {
  double rate_min_hz = 0.0;  // messages a second: the slowest and the fastest of the last windows
  double rate_max_hz = 0.0;
  std::optional<double> age_s;  // since the last good message; none: there was none yet
  std::uint64_t messages = 0;   // frames, gyro samples, telemetry
  std::uint64_t lost = 0;       // missing by sequence number, or by a gap in time (camera)
  std::uint64_t bad = 0;        // failed their check, or had a wrong length or value
  std::uint64_t skipped_bytes = 0;
  double expected_hz = 0.0;            // nominal
  std::optional<float> uncertainty_s;  // of the newest message's time, one standard deviation
};

/// Counts the messages of one device over windows of one second.
class RateMeter {
 public:
  void message(HostTime arrived);
  /// The slowest and the fastest of the last ten whole windows before `now`; zeros before the first.
  DeviceHealth health(HostTime now, const wire::Counters& counters) const;
  std::optional<HostTime> last() const { return last_; }
  std::uint64_t count() const { return count_; }

 private:
  void roll(HostTime now) const;
  mutable std::deque<std::uint32_t> windows_;  // counts of whole windows, oldest first
  mutable std::uint32_t current_ = 0;
  mutable HostTime window_begin_{};
  std::optional<HostTime> last_;
  std::uint64_t count_ = 0;
};

}  // namespace thermorig::rig
