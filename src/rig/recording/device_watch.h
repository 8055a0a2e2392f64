// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "first_bytes.h"
#include "frozen_watch.h"
#include "thermorig/core/device.h"
#include "thermorig/core/error.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"
#include "thermorig/rig/recording/health.h"
#include "thermorig/sensors/wire/counters.h"

namespace thermorig::rig {

/// How each device does: its rate, and what is wrong with it once nothing usable has come for too long. Pure.
class DeviceWatch {
 public:
  /// `start_patience_s`: how long a device may take until its first message, from `begin`.
  DeviceWatch(const RigProfile& profile, double start_patience_s, HostTime begin);

  /// What came from a device, before anything is made of it.
  void received(Device device, std::span<const std::uint8_t> bytes) { first_bytes_[device].add(bytes); }

  // A good message was in it. Each returns false if it only repeats what is known to be frozen.
  bool frame(const TimedFrame& frame, HostTime arrived);
  bool gyro(const TimedGyro& gyro, HostTime arrived);
  bool servo(const TimedServo& servo, HostTime arrived);

  /// The device went: whatever comes next is looked at anew.
  void forget(Device device) { frozen_.forget(device); }

  bool has_spoken(Device device) const { return meters_[device].count() > 0; }

  /// Why the device counts as lost: it is frozen, or has sent nothing usable for longer than its patience.
  std::optional<Error> trouble(Device device, HostTime now) const;

  DeviceHealth health(Device device, HostTime now, const wire::Counters& counters) const;

 private:
  void good(Device device, const Stamp& stamp, HostTime arrived);
  double patience_s(Device device) const;
  Error silence(Device device, double silent_s) const;

  RigProfile profile_;
  double start_patience_s_;
  HostTime begin_;
  FrozenWatch frozen_;
  PerDevice<RateMeter> meters_;
  PerDevice<std::optional<float>> uncertainty_s_;  // of the newest message's time
  std::uint64_t missing_frames_ = 0;
  PerDevice<FirstBytes> first_bytes_;  // since the last good message
};

}  // namespace thermorig::rig
