// SPDX-License-Identifier: MIT
#include "device_watch.h"

#include <fmt/format.h>

#include <algorithm>

#include "recording_start.h"
#include "thermorig/rig/link_load.h"

namespace thermorig::rig {

namespace {

constexpr double silence_s = 3.0;        // then a device that has spoken before counts as lost
constexpr double silent_periods = 10.0;  // or so many of its periods, if they are longer

}  // namespace

DeviceWatch::DeviceWatch(const RigProfile& profile, double start_patience_s, HostTime begin)
    : profile_(profile), start_patience_s_(start_patience_s), begin_(begin) {}

void DeviceWatch::received(Device device, std::span<const std::uint8_t> bytes) {
  std::vector<std::uint8_t>& kept = first_bytes_[device];
  const std::size_t room = first_bytes_kept - std::min(first_bytes_kept, kept.size());
  const auto some = bytes.first(std::min(room, bytes.size()));
  kept.insert(kept.end(), some.begin(), some.end());
}

bool DeviceWatch::frame(const TimedFrame& frame, HostTime arrived, const wire::Counters& counters) {
  missing_frames_ += frame.missing_before;
  good(Device::camera, frame.stamp, arrived, counters);
  return frozen_.frame(frame);
}

bool DeviceWatch::gyro(const TimedGyro& gyro, HostTime arrived, const wire::Counters& counters) {
  good(Device::gyro, gyro.stamp, arrived, counters);
  return frozen_.gyro(gyro);
}

bool DeviceWatch::servo(const TimedServo& servo, HostTime arrived, const wire::Counters& counters) {
  good(Device::servo, servo.stamp, arrived, counters);
  return frozen_.servo(servo);
}

void DeviceWatch::good(Device device, const Stamp& stamp, HostTime arrived, const wire::Counters& counters) {
  meters_[device].message(arrived);
  first_bytes_[device].clear();
  bytes_at_good_[device] = counters.bytes_received;
  uncertainty_s_[device] = stamp.uncertainty_s;
}

double DeviceWatch::patience_s(Device device) const {
  const double periods_s = silent_periods / link_load(device, profile_).rate_hz;
  return std::max(has_spoken(device) ? silence_s : start_patience_s_, periods_s);
}

std::optional<Error> DeviceWatch::trouble(Device device, HostTime now, const wire::Counters& counters) const {
  if (const auto& frozen = frozen_.trouble(device))
    return Error(ExitCode::device_lost, *frozen, place_of(device, profile_),
                 "unplug it and plug it in again, so that it starts anew");
  const double silent_s = to_s(now - meters_[device].last().value_or(begin_));
  if (silent_s <= patience_s(device)) return std::nullopt;
  return silence(device, silent_s, counters);
}

Error DeviceWatch::silence(Device device, double silent_s, const wire::Counters& counters) const {
  if (!has_spoken(device)) return silent_device(device, profile_, counters, first_bytes_[device]);
  const std::uint64_t bytes = counters.bytes_received - bytes_at_good_[device];
  if (bytes > 0) return unreadable_device(device, profile_, {bytes, silent_s}, first_bytes_[device]);
  return {ExitCode::device_lost, fmt::format("nothing has come from it for {:.1f} s", silent_s),
          place_of(device, profile_), "check cable and power, then record again"};
}

DeviceHealth DeviceWatch::health(Device device, HostTime now, const wire::Counters& counters) const {
  DeviceHealth health = meters_[device].health(now, counters);
  health.expected_hz = link_load(device, profile_).rate_hz;
  health.uncertainty_s = uncertainty_s_[device];
  if (device == Device::camera) health.lost += missing_frames_;
  return health;
}

}  // namespace thermorig::rig
