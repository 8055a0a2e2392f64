// SPDX-License-Identifier: MIT
#include "thermorig/simulation/virtual_rig.h"

#include <algorithm>
#include <array>
#include <string>

#include "thermorig/simulation/camera.h"
#include "thermorig/simulation/gyro.h"
#include "thermorig/simulation/panorama.h"
#include "thermorig/simulation/servo_plant.h"
#include "thermorig/simulation/servo_side.h"
#include "thermorig/simulation/shaft.h"
#include "thermorig/simulation/usb_link.h"
#include "thermorig/wire/device_bytes.h"

namespace thermorig::simulation {
namespace {

constexpr std::int64_t slice_ns = 10'000'000;  // how far the firmware runs ahead of the shaft

// The shaft stays behind the firmware by more than the rounding of its clock, so that no pulse comes too late
// for it and nothing depends on where a call to advance() ends.
constexpr std::int64_t shaft_delay_ns = 10'000;

constexpr std::int64_t gyro_backlog_ns = 50'000'000;  // what a gyro's transmit buffer holds

CameraConfig camera_config(const VirtualRigConfig& rig) {
  return {.field_of_view_deg = rig.profile.camera.field_of_view_deg,
          .output_rate_hz = rig.profile.camera.output_rate_hz,
          .half_fresh = rig.half_fresh,
          .mirrored = rig.profile.camera.mirrored,
          .warm = rig.warm,
          .clock_error = rig.camera_clock_error};
}

}  // namespace

struct VirtualRig::Parts {
  Parts(const VirtualRigConfig& rig, std::unique_ptr<Firmware> firmware);

  void run_slice(std::int64_t until_ns);
  void run_servo(std::int64_t until_ns);
  void turn_shaft(std::int64_t until_ns);
  void send_frames();
  void send_gyro();
  void remember(std::vector<SentMessage>& sent, std::uint64_t& count, const ShaftMark& begin,
                const ShaftMark& end) const;
  HostTime host_time(std::int64_t time_ns) const { return config.start + HostDuration(time_ns); }

  VirtualRigConfig config;
  ServoSide servo;
  ServoPlant plant;
  Shaft shaft;
  Camera camera;
  Gyro gyro;
  UartLine camera_line, gyro_line;
  std::array<UsbPath, device_count> paths;  // by device
  std::vector<TimedByte> line_bytes;
  std::int64_t now_ns = 0;

  bool keep_truth = false;
  std::vector<TruthSample> shaft_truth;
  std::vector<SentMessage> frames, gyro_samples;
  std::vector<PulseEdge> pulses;
  std::uint64_t frame_count = 0, gyro_count = 0;
};

VirtualRig::Parts::Parts(const VirtualRigConfig& rig, std::unique_ptr<Firmware> firmware)
    : config(rig),
      servo(std::move(firmware), rig.profile.servo.link.baud, rig.seed),
      plant(rig.profile.servo, rig.servo_loop_hz, rig.seed),
      shaft(plant.angle_deg()),
      camera(camera_config(rig), make_panorama(rig.environment, rig.seed), rig.seed),
      gyro(rig.profile.gyro, rig.gyro_grade, rig.seed),
      camera_line(rig.profile.camera.link.baud),
      gyro_line(rig.profile.gyro.link.baud),
      paths{UsbPath(rig.links[Device::camera], rig.seed, name_of(Device::camera)),
            UsbPath(rig.links[Device::gyro], rig.seed, name_of(Device::gyro)),
            UsbPath(rig.links[Device::servo], rig.seed, name_of(Device::servo))} {}

void VirtualRig::Parts::run_slice(std::int64_t until_ns) {
  run_servo(until_ns);
  turn_shaft(until_ns - shaft_delay_ns);
  send_frames();
  send_gyro();
  now_ns = until_ns;
}

void VirtualRig::Parts::run_servo(std::int64_t until_ns) {
  const auto output = servo.run_until(until_ns);
  paths[index_of(Device::servo)].push(output.bytes);
  for (const PulseEdge& pulse : output.pulses) plant.pulse(servo.end_ns(pulse), pulse.width_us);
  if (keep_truth) pulses.insert(pulses.end(), output.pulses.begin(), output.pulses.end());
}

void VirtualRig::Parts::turn_shaft(std::int64_t until_ns) {
  while (shaft.known_until_ns() + Shaft::step_ns <= until_ns) {
    plant.step(shaft.known_until_ns());
    shaft.append(plant.angle_deg());
    const std::int64_t time_ns = shaft.known_until_ns();
    if (keep_truth && time_ns % 1'000'000 == 0)
      shaft_truth.push_back({host_time(time_ns), plant.angle_deg(), plant.rate_dps()});
  }
}

void VirtualRig::Parts::remember(std::vector<SentMessage>& sent, std::uint64_t& count, const ShaftMark& begin,
                                 const ShaftMark& end) const {
  const std::uint64_t index = count++;
  if (keep_truth)
    sent.push_back({index, host_time(begin.time_ns), host_time(end.time_ns), mean_rate_dps(begin, end)});
}

/// A bridge whose line is still busy with the frame before leaves a frame out.
void VirtualRig::Parts::send_frames() {
  for (const SimulatedFrame& frame : camera.follow(shaft)) {
    if (camera_line.backlog_ns(frame.ready_ns) > 0) continue;
    line_bytes.clear();
    camera_line.send(wire::camera_frame(frame.frame), frame.ready_ns, line_bytes);
    paths[index_of(Device::camera)].push(line_bytes);
    remember(frames, frame_count, frame.exposure_begin, frame.exposure_end);
  }
}

void VirtualRig::Parts::send_gyro() {
  for (const SimulatedGyroSample& sample : gyro.follow(shaft)) {
    if (gyro_line.backlog_ns(sample.ready_ns) > gyro_backlog_ns) continue;
    line_bytes.clear();
    gyro_line.send(gyro_bytes(sample, config.profile.gyro), sample.ready_ns, line_bytes);
    paths[index_of(Device::gyro)].push(line_bytes);
    remember(gyro_samples, gyro_count, sample.begin, sample.end);
  }
}

VirtualRig::VirtualRig(const VirtualRigConfig& config, std::unique_ptr<Firmware> firmware)
    : parts_(std::make_unique<Parts>(config, std::move(firmware))) {}

VirtualRig::~VirtualRig() = default;

void VirtualRig::send(Device to, std::span<const std::uint8_t> bytes, HostTime now) {
  if (to != Device::servo) return;
  const std::int64_t now_ns = std::max(parts_->now_ns, (now - parts_->config.start).count());
  parts_->servo.send(bytes, parts_->paths[index_of(to)].outgoing_ns(now_ns));
}

std::vector<Chunk> VirtualRig::advance(HostTime until) {
  const std::int64_t until_ns = (until - parts_->config.start).count();
  while (parts_->now_ns < until_ns) parts_->run_slice(std::min(parts_->now_ns + slice_ns, until_ns));
  std::vector<Chunk> chunks;
  for (const Device device : all_devices)
    for (TimedBytes& read : parts_->paths[index_of(device)].reads(parts_->now_ns))
      chunks.push_back({device, parts_->host_time(read.time_ns), std::move(read.bytes)});
  std::stable_sort(chunks.begin(), chunks.end(),
                   [](const Chunk& left, const Chunk& right) { return left.arrived < right.arrived; });
  return chunks;
}

const std::vector<TruthSample>& VirtualRig::shaft() const {
  return parts_->shaft_truth;
}
const std::vector<SentMessage>& VirtualRig::sent_frames() const {
  return parts_->frames;
}
const std::vector<SentMessage>& VirtualRig::sent_gyro() const {
  return parts_->gyro_samples;
}
const std::vector<PulseEdge>& VirtualRig::pulses() const {
  return parts_->pulses;
}
void VirtualRig::keep_truth(bool keep) {
  parts_->keep_truth = keep;
}

}  // namespace thermorig::simulation
