// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/pipeline.h"

#include <utility>

#include "camera_line.h"
#include "gyro_line.h"
#include "servo_line.h"
#include "thermorig/sensors/device_stream.h"

namespace thermorig::pipeline {

struct Pipeline::Stages {
  CameraLine camera;
  GyroLine gyro;
  ServoLine servo;
  labels::Labeller labeller;
  Streams streams;
  PerDevice<std::uint64_t> message_bytes;  // at most
};

namespace {
PerDevice<std::uint64_t> message_bytes(const RigProfile& profile) {
  PerDevice<std::uint64_t> bytes;
  for (const Device device : all_devices)
    bytes[device] = sensors::device_stream(device, profile).message_bytes;
  return bytes;
}
}  // namespace

Pipeline::Pipeline(const RigProfile& profile, const Fits& fits)
    : stages_(new Stages{.camera = CameraLine(profile.camera, fits),
                         .gyro = GyroLine(profile.gyro, fits),
                         .servo = ServoLine(profile.servo, fits),
                         .labeller = labels::Labeller(labels::label_config(profile, fits.sync)),
                         .streams = {},
                         .message_bytes = message_bytes(profile)}) {}

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

std::vector<LabelledSample> Pipeline::feed(Device from, std::span<const std::uint8_t> chunk,
                                           HostTime arrived) {
  auto& [camera, gyro, servo, labeller, streams, message_bytes] = *stages_;
  switch (from) {  // each line: bytes -> messages (bad bytes are counted, not thrown) -> timed samples
    case Device::camera:
      for (const TimedFrame& frame : camera.push(chunk, arrived, streams.frames)) labeller.add(frame);
      break;
    case Device::gyro:
      for (const TimedGyro& sample : gyro.push(chunk, arrived, streams.gyro)) labeller.add(sample);
      break;
    case Device::servo:
      for (const TimedServo& state : servo.push(chunk, arrived, streams)) labeller.add(state);
      break;
  }
  return labeller.take(arrived);  // the frames whose telemetry and gyro samples are all there, labelled
}

void Pipeline::sent(Device to, std::span<const std::uint8_t> bytes, HostTime before_write) {
  if (to == Device::servo) stages_->servo.sent(bytes, before_write);
}

std::vector<LabelledSample> Pipeline::interrupt(Device device, HostTime now) {
  auto& [camera, gyro, servo, labeller, streams, message_bytes] = *stages_;
  switch (device) {
    case Device::camera:
      for (const TimedFrame& frame : camera.interrupt(streams.frames)) labeller.add(frame);
      break;
    case Device::gyro:
      for (const TimedGyro& sample : gyro.interrupt(streams.gyro)) labeller.add(sample);
      break;
    case Device::servo:
      servo.interrupt(streams);  // a frame of the servo link ends with its flag: nothing waits
      break;
  }
  return labeller.take(now);
}

std::vector<LabelledSample> Pipeline::finish() {
  auto& [camera, gyro, servo, labeller, streams, message_bytes] = *stages_;
  for (const TimedFrame& frame : camera.finish(streams.frames)) labeller.add(frame);
  for (const TimedGyro& sample : gyro.finish(streams.gyro)) labeller.add(sample);
  for (const TimedServo& state : servo.finish(streams)) labeller.add(state);
  return labeller.finish();
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
