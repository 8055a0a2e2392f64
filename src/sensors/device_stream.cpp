// SPDX-License-Identifier: MIT
#include "thermorig/sensors/device_stream.h"

#include <algorithm>
#include <utility>

#include "thermorig/sensors/gyro_protocol.h"
#include "thermorig/sensors/servo_protocol.h"

namespace thermorig::sensors {

namespace {

Commands request_of(const GyroProfile& profile, unsigned asked) {
  const GyroProtocol& protocol = gyro_protocol(profile.protocol);
  std::vector<std::uint8_t> bytes;
  if (protocol.request != nullptr) bytes = protocol.request(profile, asked);
  return bytes.empty() ? Commands() : Commands{std::move(bytes)};
}

void add_steps(std::span<const UsualBaud> bauds, const std::vector<std::uint8_t>& greeting,
               bool only_if_silent, std::vector<SearchStep>& steps) {
  for (const UsualBaud& usual : bauds) {
    const auto same = std::find_if(steps.begin(), steps.end(),
                                   [&](const auto& step) { return step.at.baud == usual.baud; });
    const bool is_other_greeting = same != steps.end() && !same->greeting.empty() && !greeting.empty();
    if (same == steps.end() || is_other_greeting) {
      steps.push_back({usual, greeting, only_if_silent});
      continue;
    }
    same->at.share = std::max(same->at.share, usual.share);
    if (greeting.empty()) continue;
    same->greeting = greeting;
    same->only_if_silent = only_if_silent;
  }
}

}  // namespace

DeviceStream device_stream(Device device, const RigProfile& profile) {
  switch (device) {
    case Device::camera: {
      const CameraProtocol& camera = camera_protocol(profile.camera.protocol);
      return {camera.name, camera.sends, camera.message_bytes, profile.camera.output_rate_hz, camera.clock};
    }
    case Device::gyro: {
      const GyroProtocol& gyro = gyro_protocol(profile.gyro.protocol);
      return {gyro.name, gyro.sends, gyro.message_bytes(profile.gyro), profile.gyro.output_rate_hz,
              gyro.clock(profile.gyro)};
    }
    case Device::servo:
      break;
  }
  const ServoProtocol& servo = servo_protocol(profile.servo.protocol);
  return {servo.name, servo.sends, servo.message_bytes, servo.rate_hz, servo.clock};
}

Commands stream_request(Device device, const RigProfile& profile, unsigned asked) {
  switch (device) {
    case Device::camera: {
      const CameraProtocol& camera = camera_protocol(profile.camera.protocol);
      return camera.request == nullptr ? Commands() : camera.request(profile.camera);
    }
    case Device::gyro:
      return request_of(profile.gyro, asked);
    case Device::servo:
      break;
  }
  return {};
}

std::vector<std::uint8_t> next_request(Device device, const RigProfile& profile) {
  if (device != Device::camera) return {};
  const CameraProtocol& camera = camera_protocol(profile.camera.protocol);
  return camera.next == nullptr ? std::vector<std::uint8_t>() : camera.next(profile.camera);
}

std::vector<Recognised> recognise(std::span<const std::uint8_t> bytes, double heard_s) {
  std::vector<Recognised> found;
  const auto add = [&](std::optional<Device> role, std::string_view protocol,
                       std::optional<Evidence> evidence) {
    if (evidence) found.push_back({role, protocol, *std::move(evidence)});
  };
  for (const CameraProtocol& camera : camera_protocols())
    add(Device::camera, camera.name, camera.recognise(bytes));
  if (found.empty()) add(std::nullopt, "", recognise_foreign(bytes));
  const bool is_foreign = !found.empty();
  for (const ServoProtocol& servo : servo_protocols()) add(Device::servo, servo.name, servo.recognise(bytes));
  for (const GyroProtocol& gyro : gyro_protocols())
    if (!gyro.has_columns || !is_foreign) add(Device::gyro, gyro.name, gyro.recognise(bytes, heard_s));
  const bool is_known = std::any_of(found.begin(), found.end(), [](const Recognised& one) {
    return one.evidence.messages > 0 || !one.evidence.advice.empty();
  });
  if (!is_known)
    if (auto unread = recognise_unread(bytes))
      found.insert(found.begin(), {std::nullopt, "", *std::move(unread)});
  return found;
}

std::vector<SearchStep> search_steps() {
  std::vector<SearchStep> steps;
  for (const CameraProtocol& camera : camera_protocols()) {
    const bool listens = camera.greeting != nullptr;
    add_steps(camera.bauds, listens ? camera.greeting() : std::vector<std::uint8_t>(), listens, steps);
  }
  for (const GyroProtocol& gyro : gyro_protocols()) add_steps(gyro.bauds, {}, false, steps);
  for (const ServoProtocol& servo : servo_protocols())
    add_steps(servo.bauds, servo.greeting(), servo.is_silent, steps);
  return steps;
}

}  // namespace thermorig::sensors
