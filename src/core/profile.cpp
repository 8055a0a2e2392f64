// SPDX-License-Identifier: MIT
#include "thermorig/core/profile.h"

#include <cmath>

namespace thermorig {

namespace {
/// Sketches read one half-frame, then the other, and send both as one frame when they come to it: all that is
/// known is that the newer one had its end within the last refresh. Those that sensors/camera_protocol.h has
/// a remark on, which a test checks: labels know of no protocols.
bool merges_halves(const CameraProfile& camera) {
  return camera.protocol == "text" || camera.protocol == "binary";
}
}  // namespace

double latency_uncertainty_s(const CameraProfile& camera) {
  if (!camera.link.latency_measured_utc.empty()) return camera.link.latency_uncertainty_s;
  // Root mean square of what lies evenly between 0 and half of a refresh; a frame is at least one.
  const double rows_s = 0.5 / (std::sqrt(3.0) * camera.output_rate_hz);
  // A merged frame takes two refreshes.
  const double merged_s = merges_halves(camera) ? 0.5 / (std::sqrt(3.0) * camera.output_rate_hz) : 0.0;
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
