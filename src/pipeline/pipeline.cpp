// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/pipeline.h"

#include <utility>

#include "absent_camera.h"
#include "camera_decoder.h"
#include "gyro_decoder.h"
#include "measurements.h"
#include "servo_decoder.h"
#include "thermorig/sensors/camera_protocol.h"
#include "thermorig/sensors/device_stream.h"
#include "thermorig/sensors/servo_protocol.h"

namespace thermorig::pipeline {

struct Pipeline::Stages {
  CameraDecoder camera;
  GyroDecoder gyro;
  ServoDecoder servo;
  labels::Labeller labeller;
  double frame_rate_hz;  // nominal
  Measurements measurements;
  Streams streams;
  PerDevice<std::uint64_t> message_bytes;  // at most
  std::optional<AbsentCamera> absent_camera;
  bool without_labels;

  template <typename Timed>
  void add(std::span<const Timed> samples) {
    if (without_labels) return;
    for (const Timed& sample : samples) {
      labeller.add(sample);
      measurements.add(sample);
    }
  }

  /// The camera's own frames; once others stand in for them they are of no more use.
  void add_frames(std::span<const TimedFrame> frames) {
    if (!absent_camera || !absent_camera->has_begun()) add(frames);
  }

  void add_servo(const ServoDecoder::Decoded& decoded) {
    add(decoded.servo);
    if (without_labels) return;
    for (const TimedShaft& reading : decoded.shaft) labeller.add(reading);
  }

  /// The frames whose telemetry and gyro samples are all there.
  std::vector<Measurement> complete(HostTime now) {
    if (absent_camera) add(absent_camera->due(now, streams.stand_ins));
    return measurements.with(labeller.take(now));
  }
};

namespace {
PerDevice<std::uint64_t> message_bytes(const RigProfile& profile) {
  PerDevice<std::uint64_t> bytes;
  for (const Device device : all_devices)
    bytes[device] = sensors::device_stream(device, profile).message_bytes;
  return bytes;
}

labels::LabelConfig label_config(const RigProfile& profile, const Fits& fits) {
  labels::LabelConfig config = labels::label_config(
      profile, fits.sync, sensors::camera_protocol(profile.camera.protocol).merges_halves);
  const sensors::ServoProtocol& servo = sensors::servo_protocol(profile.servo.protocol);
  config.telemetry_gap_s = servo.longest_gap_s;
  if (servo.telemetry_request != nullptr) config.bridged_silence_s = servo.longest_gap_s;
  return config;
}
}  // namespace

Pipeline::Pipeline(const RigProfile& profile, const Fits& fits, bool without_labels)
    : stages_(new Stages{.camera = CameraDecoder(profile.camera, fits),
                         .gyro = GyroDecoder(profile.gyro, fits),
                         .servo = ServoDecoder(profile.servo, profile.encoder, fits),
                         .labeller = labels::Labeller(label_config(profile, fits)),
                         .frame_rate_hz = profile.camera.output_rate_hz,
                         .measurements = {},
                         .streams = {},
                         .message_bytes = message_bytes(profile),
                         .absent_camera = {},
                         .without_labels = without_labels}) {}

Pipeline::~Pipeline() = default;
Pipeline::Pipeline(Pipeline&&) noexcept = default;
Pipeline& Pipeline::operator=(Pipeline&&) noexcept = default;

void Pipeline::expect(const PerDevice<std::uint64_t>& bytes) {
  const auto messages = [&](Device device) { return bytes[device] / stages_->message_bytes[device]; };
  Streams& streams = stages_->streams;
  streams.frames.reserve(messages(Device::camera));
  streams.gyro.reserve(messages(Device::gyro));
  streams.servo.reserve(messages(Device::servo));
}

std::vector<Measurement> Pipeline::feed(Device from, std::span<const std::uint8_t> chunk, HostTime arrived) {
  Stages& stages = *stages_;
  switch (from) {  // each line: bytes -> messages (bad bytes are counted, not thrown) -> timed samples
    case Device::camera:
      stages.add_frames(stages.camera.push(chunk, arrived, stages.streams.frames));
      break;
    case Device::gyro:
      stages.add(stages.gyro.push(chunk, arrived, stages.streams.gyro));
      break;
    case Device::servo:
      stages.add_servo(stages.servo.push(chunk, arrived, stages.streams));
      break;
  }
  return stages.complete(arrived);
}

void Pipeline::sent(Device to, std::span<const std::uint8_t> bytes, HostTime before_write) {
  if (to == Device::servo) stages_->servo.sent(bytes, before_write);
}

std::vector<Measurement> Pipeline::interrupt(Device device, HostTime now) {
  Stages& stages = *stages_;
  switch (device) {
    case Device::camera:
      stages.add_frames(stages.camera.interrupt(stages.streams.frames));
      break;
    case Device::gyro:
      stages.add(stages.gyro.interrupt(stages.streams.gyro));
      break;
    case Device::servo:
      stages.servo.interrupt(stages.streams);  // a frame of the servo link ends with its flag: nothing waits
      break;
  }
  return stages.complete(now);
}

void Pipeline::stand_in_for_camera(HostTime since) {
  stages_->absent_camera.emplace(stages_->frame_rate_hz, since);
}

bool Pipeline::stands_in_for_camera() const {
  return stages_->absent_camera && stages_->absent_camera->has_begun();
}

std::vector<Measurement> Pipeline::finish() {
  Stages& stages = *stages_;
  stages.add_frames(stages.camera.finish(stages.streams.frames));
  stages.add(stages.gyro.finish(stages.streams.gyro));
  stages.add_servo(stages.servo.finish(stages.streams));
  return stages.measurements.with(stages.labeller.finish());
}

Streams Pipeline::take_streams() {
  return std::exchange(stages_->streams, {});
}

const wire::Counters& Pipeline::counters(Device device) const {
  switch (device) {
    case Device::camera:
      return stages_->camera.counters();
    case Device::gyro:
      return stages_->gyro.counters();
    case Device::servo:
      break;
  }
  return stages_->servo.counters();
}

}  // namespace thermorig::pipeline
