// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "thermorig/core/auto_zero.h"
#include "thermorig/core/device.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"

namespace thermorig::rig {

/// Notices devices that repeat the same message for ever: what they send is well-formed, and wrong.
///   camera  not one pixel changes over 8 frames and 2 s: its noise alone changes some of each frame
///   gyro    every axis reads the same for 1 s while the servo turns; at rest a gyro may well read zeros. One
///           with fewer than two axes that tell noise may read the same for a whole leg: there it takes 1 s
///           behind a change of the servo's speed. Axes at the end of their range do not count
///   servo   its clock stands still over 10 messages and 1 s
/// Pure.
class FrozenWatch {
 public:
  // Each returns false if the message only repeats what is known to be frozen.
  bool frame(const TimedFrame& frame);
  bool gyro(const TimedGyro& sample);
  bool servo(const TimedServo& state);

  /// What it does, ready to print; none: nothing is wrong with it.
  const std::optional<std::string>& trouble(Device device) const { return trouble_[device]; }

  /// The device went: whatever comes next is looked at anew.
  void forget(Device device);

 private:
  struct Repeats {
    HostTime since{};
    std::uint64_t count = 0;  // messages like the one before
    bool last(HostTime now, std::uint64_t messages, HostDuration span) const {
      return count >= messages && now - since >= span;
    }
  };
  void begin(Device device, HostTime now);

  PerDevice<std::optional<std::string>> trouble_;
  Repeats camera_repeats_, servo_repeats_;
  RepeatedReading gyro_;                                // while the servo turns
  std::optional<std::array<float, 3>> stuck_rate_dps_;  // as long as nothing else comes, it is not back
  std::optional<std::uint32_t> last_mcu_us_;
  bool turns(HostTime now) const;
  bool is_lively() const;
  void note_changes(const std::array<float, 3>& rate_dps);
  bool outlives_a_change(HostTime now);

  std::optional<HostTime> servo_heard_;  // none: it is away
  double servo_dps_ = 0.0;               // commanded, by its telemetry
  std::optional<double> settled_dps_;    // the same, a while after the gyro's last change
  bool speed_changed_ = false;           // since then
  std::uint64_t turning_samples_ = 0;
  std::array<std::uint64_t, 3> changes_{};  // of each axis, in those
};

}  // namespace thermorig::rig
