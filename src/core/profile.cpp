// SPDX-License-Identifier: MIT
#include "thermorig/core/profile.h"

#include <cmath>

namespace thermorig {

double latency_uncertainty_s(const CameraProfile& camera, bool merges_halves) {
  if (!camera.link.latency_measured_utc.empty()) return camera.link.latency_uncertainty_s;
  // Root mean square of what lies evenly between 0 and half of a refresh; a frame is at least one.
  const double rows_s = 0.5 / (std::sqrt(3.0) * camera.output_rate_hz);
  // A merged frame takes two refreshes.
  const double merged_s = merges_halves ? 0.5 / (std::sqrt(3.0) * camera.output_rate_hz) : 0.0;
  return std::hypot(camera.link.latency_uncertainty_s, rows_s, merged_s);
}

double GyroProfile::setting(const std::string& setting_name) const {
  const auto found = settings.find(setting_name);
  return found == settings.end() ? 0.0 : found->second;
}

PortProfile& RigProfile::link(Device device) {
  return const_cast<PortProfile&>(static_cast<const RigProfile&>(*this).link(device));
}

const PortProfile& RigProfile::link(Device device) const {
  switch (device) {
    case Device::camera:
      return camera.link;
    case Device::gyro:
      return gyro.link;
    case Device::servo:
      break;
  }
  return servo.link;
}

}  // namespace thermorig
