// SPDX-License-Identifier: MIT
#include "frozen_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace thermorig::rig {

namespace {

constexpr std::uint64_t fewest_frames = 8;
constexpr auto frames_span = std::chrono::seconds(2);
constexpr std::uint64_t fewest_samples = 20;
constexpr auto samples_span = std::chrono::seconds(1);
constexpr std::uint64_t fewest_telemetry = 10;
constexpr auto telemetry_span = std::chrono::seconds(1);
constexpr double turning_dps = 5.0;  // far above the resolution and the noise of any gyro
constexpr auto telemetry_lasts = std::chrono::milliseconds(500);  // then nobody knows whether the servo turns
constexpr auto shaft_follows = std::chrono::milliseconds(300);    // what was commanded
constexpr double lively_share = 0.25;  // of the samples in which an axis changes: below, 1 s may pass without
constexpr std::ptrdiff_t lively_axes = 2;

std::string gyro_text(const GyroReading& reading) {
  if (reading.is_zero())
    return "it has read exactly 0 for 1 s while the servo was commanded to turn: it hangs, or the servo does "
           "not turn";
  return "it has sent the same sample for 1 s while the servo turned: it hangs";
}

}  // namespace

void FrozenWatch::begin(Device device, HostTime now) {
  if (device == Device::camera) camera_repeats_ = {.since = now, .count = 0};
  if (device == Device::servo) servo_repeats_ = {.since = now, .count = 0};
  trouble_[device].reset();
}

void FrozenWatch::forget(Device device) {
  begin(device, HostTime::max());
  if (device == Device::gyro) {
    gyro_ = RepeatedReading();
    turning_samples_ = 0;
    changes_ = {};
  }
  if (device == Device::servo) {
    last_mcu_us_.reset();
    servo_heard_.reset();
  }
}

bool FrozenWatch::frame(const TimedFrame& frame) {
  const HostTime now = frame.stamp.arrival;
  if (frame.fresh_even + frame.fresh_odd > 0) {
    begin(Device::camera, now);
    return true;
  }
  Repeats& repeats = camera_repeats_;
  ++repeats.count;
  if (repeats.last(now, fewest_frames, frames_span))
    trouble_[Device::camera] =
        fmt::format("it has sent the same frame {} times: it hangs", repeats.count + 1);
  return false;
}

bool FrozenWatch::turns(HostTime now) const {
  return servo_heard_ && now - *servo_heard_ <= telemetry_lasts && std::abs(servo_dps_) >= turning_dps;
}

bool FrozenWatch::is_lively() const {
  const double needed = lively_share * static_cast<double>(turning_samples_);
  return turning_samples_ >= fewest_samples &&
         std::count_if(changes_.begin(), changes_.end(), [needed](std::uint64_t changes) {
           return static_cast<double>(changes) >= needed;
         }) >= lively_axes;
}

void FrozenWatch::note_changes(const std::array<float, 3>& rate_dps) {
  if (!gyro_.last()) return;
  ++turning_samples_;
  for (std::size_t axis = 0; axis < rate_dps.size(); ++axis)
    if (rate_dps[axis] != gyro_.last()->rate_dps[axis]) ++changes_[axis];
}

/// The servo's speed has changed while the samples repeat; they are counted anew then, for the shaft may
/// follow late.
bool FrozenWatch::outlives_a_change(HostTime now) {
  if (speed_changed_ || !gyro_.lasts(shaft_follows)) return speed_changed_;
  if (!settled_dps_) settled_dps_ = servo_dps_;
  speed_changed_ = std::abs(servo_dps_ - *settled_dps_) >= turning_dps;
  if (speed_changed_) gyro_.restart(now);
  return speed_changed_;
}

bool FrozenWatch::gyro(const TimedGyro& sample) {
  const HostTime now = sample.stamp.arrival;
  const std::array<float, 3>& rate_dps = sample.reading.rate_dps;
  const bool is_turning = turns(now);
  if (is_turning) note_changes(rate_dps);
  const bool repeats_last = gyro_.add(sample.reading, now);
  // Zeros are what a sound one may read at rest.
  if (stuck_rate_dps_ == rate_dps && (is_turning || !sample.reading.is_zero())) return false;
  stuck_rate_dps_.reset();
  if (!repeats_last || !is_turning || sample.reading.saturated) {
    trouble_[Device::gyro].reset();
    gyro_.restart(now);
    settled_dps_.reset();
    speed_changed_ = false;
    return true;
  }
  const bool ought_to_differ = outlives_a_change(now) || sample.reading.is_zero() || is_lively();
  if (ought_to_differ && gyro_.repeats() >= fewest_samples && gyro_.lasts(samples_span)) {
    trouble_[Device::gyro] = gyro_text(sample.reading);
    stuck_rate_dps_ = rate_dps;
  }
  return true;
}

bool FrozenWatch::servo(const TimedServo& state) {
  const HostTime now = state.stamp.arrival;
  servo_heard_ = now;
  servo_dps_ = state.state.rate_dps;
  const bool stands_still = last_mcu_us_ == state.state.mcu_us;
  last_mcu_us_ = state.state.mcu_us;
  if (!stands_still) {
    begin(Device::servo, now);
    return true;
  }
  Repeats& repeats = servo_repeats_;
  ++repeats.count;
  if (repeats.last(now, fewest_telemetry, telemetry_span))
    trouble_[Device::servo] =
        fmt::format("its clock has stood still for {} messages: its board hangs", repeats.count + 1);
  return false;
}

}  // namespace thermorig::rig
