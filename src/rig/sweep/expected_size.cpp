// SPDX-License-Identifier: MIT
#include "thermorig/rig/sweep/expected_size.h"

#include "thermorig/sensors/device_stream.h"

namespace thermorig::rig {

LinkLoad link_load(Device device, const RigProfile& profile) {
  const sensors::DeviceStream stream = sensors::device_stream(device, profile);
  return {stream.message_bytes, stream.rate_hz};
}

std::uint64_t expected_journal_bytes(const SweepPlan& plan, const RigProfile& profile) {
  constexpr double record_bytes = 40.0;      // the journal's own, of each chunk
  constexpr double chunks_per_frame = 50.0;  // a frame comes in parts of 32 bytes or more
  constexpr double sent_hz = 30.0;           // refreshes, pings and commands to the servo a second
  constexpr double sent_bytes = 32.0;        // of one, at most
  const LinkLoad camera = link_load(Device::camera, profile);
  const LinkLoad gyro = link_load(Device::gyro, profile);
  const LinkLoad servo = link_load(Device::servo, profile);
  const double received_per_s = camera.bytes_per_s() + gyro.bytes_per_s() + servo.bytes_per_s();
  const double chunks_per_s = chunks_per_frame * camera.rate_hz + gyro.rate_hz + servo.rate_hz + sent_hz;
  const double bytes_per_s = received_per_s + sent_hz * sent_bytes + record_bytes * chunks_per_s;
  const double duration_s = plan_duration_s(plan, profile.servo, profile.camera.output_rate_hz);
  return static_cast<std::uint64_t>(bytes_per_s * (1.2 * duration_s + 10.0));
}

std::uint64_t session_bytes_beside(std::uint64_t journal_bytes) {
  return journal_bytes / 2;
}

std::uint64_t expected_recording_bytes(const SweepPlan& plan, const RigProfile& profile) {
  const std::uint64_t journal_bytes = expected_journal_bytes(plan, profile);
  return journal_bytes + session_bytes_beside(journal_bytes);
}

}  // namespace thermorig::rig
