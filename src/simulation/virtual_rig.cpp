// SPDX-License-Identifier: MIT
#include "thermorig/simulation/virtual_rig.h"

#include <algorithm>
#include <array>

#include "as5600.h"
#include "camera.h"
#include "gyro.h"
#include "hand.h"
#include "host_clock.h"
#include "servo_plant.h"
#include "servo_side.h"
#include "shaft.h"
#include "thermorig/simulation/panorama.h"
#include "usb_link.h"

namespace thermorig::simulation {
namespace {

constexpr std::int64_t slice_ns = 10'000'000;              // how far the firmware runs ahead of the shaft
constexpr std::int64_t encoder_slice_ns = Shaft::step_ns;  // the same of one that reads the shaft

// The shaft stays behind the firmware by more than the rounding of its clock, so that no pulse comes too late
// for it and nothing depends on where a call to advance() ends.
constexpr std::int64_t shaft_delay_ns = 10'000;

constexpr std::int64_t gyro_backlog_ns = 50'000'000;  // what a gyro's transmit buffer holds

CameraConfig camera_config(const VirtualRigConfig& rig) {
  return {.field_of_view_deg = rig.profile.camera.field_of_view_deg,
          .output_rate_hz = rig.profile.camera.output_rate_hz,
          .half_fresh = rig.half_fresh,
          .mirrored = rig.profile.camera.mirrored != (rig.world.camera.turned_over >= 0.5),
          .warm = rig.warm,
          .clock_error = rig.camera_clock_error,
          .latency_s = rig.camera_latency_s,
          .world = rig.world.camera,
          .scene = rig.world.scene};
}

bool is_on_bus(const CameraProfile& camera) {
  return camera.link.baud == 0;
}

std::uint32_t camera_line_baud(const VirtualRigConfig& rig) {
  return is_on_bus(rig.profile.camera) ? rig.camera_bus_baud : rig.profile.camera.link.baud;
}

/// A bus of the computer has no hub and no frames that jitter.
UsbPath path_of(const VirtualRigConfig& rig, Device device) {
  LinksWorld links = rig.world.links;
  if (device == Device::camera && is_on_bus(rig.profile.camera))
    links.hub_delay_ms = links.hub_jitter_ms = links.frame_jitter_ms = 0.0;
  return {rig.links[device], rig.seed, name_of(device), links};
}

/// The hand's turns by the host's clock, in rig time.
std::vector<HandTurn> turns_in_rig_time(const VirtualRigConfig& rig, const HostClock& clock) {
  std::vector<HandTurn> turns = rig.hand_turns;
  for (HandTurn& turn : turns)
    turn.begin = rig.start + HostDuration(clock.rig_ns((turn.begin - rig.start).count()));
  return turns;
}

/// A message on its way out of a device.
struct Message {
  std::vector<std::uint8_t> bytes;
  std::int64_t ready_ns;
  ShaftMark begin, end;  // of its exposure
};

/// A device's line, and what it has sent.
struct Sender {
  UartLine line;
  std::vector<SentMessage> sent;  // where truth is kept
  std::uint64_t count = 0;
  bool streams = true;  // else it waits to be asked for its messages
  unsigned owed = 0;    // messages that it was asked for one by one
};

}  // namespace

struct VirtualRig::Parts {
  Parts(const VirtualRigConfig& rig, std::unique_ptr<Firmware> firmware);

  void run_slice(std::int64_t until_ns);
  void run_servo(std::int64_t until_ns);
  void turn_shaft(std::int64_t until_ns);
  void send_frames();
  void send_gyro();
  void send_idle(const SimulatedGyroSample& sample);
  void send(Device device, Sender& sender, const Message& message);
  void heard(Device device, Sender& sender, const Heard& heard, std::int64_t time_ns);
  StreamSpan pass_on(Device device, std::vector<TimedByte>& bytes);
  bool is_out(Device device, std::int64_t time_ns) const;
  HostTime host_time(std::int64_t time_ns) const {
    return config.start + HostDuration(host_clock.host_ns(time_ns));
  }
  std::int64_t rig_ns(HostTime time) const { return host_clock.rig_ns((time - config.start).count()); }

  VirtualRigConfig config;
  HostClock host_clock;
  ServoSide servo;
  ServoPlant plant;
  Hand hand;
  Shaft shaft;
  Camera camera;
  Gyro gyro;
  std::optional<As5600> encoder;
  const CameraEncoder& camera_encoder;
  const GyroEncoder& gyro_encoder;
  Sender camera_sender, gyro_sender;
  std::array<UsbPath, device_count> paths;              // by device
  std::array<std::uint64_t, device_count> passed_on{};  // bytes that reach the host
  std::vector<TimedByte> line_bytes;
  std::int64_t now_ns = 0;

  bool keep_truth = false;
  std::vector<TruthSample> shaft_truth;
  std::vector<PulseEdge> pulses;
};

VirtualRig::Parts::Parts(const VirtualRigConfig& rig, std::unique_ptr<Firmware> firmware)
    : config(rig),
      host_clock(rig.world.links.host_slew_ppm),
      servo(std::move(firmware), rig.profile.servo.link.baud, rig.seed, rig.world),
      plant(rig.profile.servo, rig.servo_loop_hz, rig.seed, rig.world.servo),
      hand(turns_in_rig_time(rig, host_clock), rig.start),
      shaft(servo.shaft_deg(0).value_or(plant.angle_deg()) + hand.angle_deg(0)),
      camera(camera_config(rig), make_panorama(rig.environment, rig.seed, rig.scene), rig.seed),
      gyro(rig.profile.gyro, rig.gyro_grade, rig.seed,
           {.latency_s = rig.gyro_latency_s, .zeroes_itself = rig.gyro_zeroes_itself}, rig.world.gyro),
      camera_encoder(simulation::camera_encoder(rig.profile.camera)),
      gyro_encoder(simulation::gyro_encoder(rig.profile.gyro)),
      camera_sender{UartLine(camera_line_baud(rig), rig.world.links.baud_error),
                    {},
                    0,
                    rig.camera_start != CameraStart::when_asked},
      gyro_sender{UartLine(rig.profile.gyro.link.baud, rig.world.links.baud_error),
                  {},
                  0,
                  rig.gyro_start == GyroStart::by_itself},
      paths{path_of(rig, Device::camera), path_of(rig, Device::gyro), path_of(rig, Device::servo)} {
  if (rig.has_encoder) encoder.emplace(rig.world.encoder, rig.seed);
}

void VirtualRig::Parts::run_slice(std::int64_t until_ns) {
  run_servo(until_ns);
  turn_shaft(until_ns - shaft_delay_ns);
  send_frames();
  send_gyro();
  now_ns = until_ns;
}

void VirtualRig::Parts::run_servo(std::int64_t until_ns) {
  if (encoder && now_ns % encoder_slice_ns == 0) servo.sense(encoder->look(shaft));
  auto output = servo.run_until(until_ns);
  pass_on(Device::servo, output.bytes);
  for (const PulseEdge& pulse : output.pulses) plant.pulse(servo.end_ns(pulse), pulse.width_us);
  if (encoder) encoder->take(output.writes);
  if (keep_truth) pulses.insert(pulses.end(), output.pulses.begin(), output.pulses.end());
}

void VirtualRig::Parts::turn_shaft(std::int64_t until_ns) {
  while (shaft.known_until_ns() + Shaft::step_ns <= until_ns) {
    plant.step(shaft.known_until_ns());
    const std::int64_t time_ns = shaft.known_until_ns() + Shaft::step_ns;
    const auto driven_deg = servo.shaft_deg(time_ns);
    const double angle_deg = driven_deg.value_or(plant.angle_deg()) + hand.angle_deg(time_ns);
    shaft.append(angle_deg);
    if (!keep_truth || time_ns % 1'000'000 != 0) continue;
    const double driven_dps =
        driven_deg ? (*driven_deg - *servo.shaft_deg(time_ns - 1'000'000)) / 1e-3 : plant.rate_dps();
    shaft_truth.push_back({host_time(time_ns), angle_deg, driven_dps + hand.rate_dps(time_ns)});
  }
}

bool VirtualRig::Parts::is_out(Device device, std::int64_t time_ns) const {
  return std::any_of(config.outages.begin(), config.outages.end(), [&](const Outage& outage) {
    return outage.device == device && outage.begin <= host_time(time_ns) && host_time(time_ns) < outage.end;
  });
}

/// Toward the host, without what an outage takes.
StreamSpan VirtualRig::Parts::pass_on(Device device, std::vector<TimedByte>& bytes) {
  std::erase_if(bytes, [&](const TimedByte& byte) { return is_out(device, byte.time_ns); });
  std::uint64_t& count = passed_on[index_of(device)];
  const StreamSpan span{count, count + bytes.size()};
  paths[index_of(device)].push(bytes);
  count = span.end;
  return span;
}

void VirtualRig::Parts::send(Device device, Sender& sender, const Message& message) {
  const std::int64_t sent_ns = message.ready_ns + sender.line.backlog_ns(message.ready_ns);
  line_bytes.clear();
  sender.line.send(message.bytes, message.ready_ns, line_bytes);
  const StreamSpan span = pass_on(device, line_bytes);
  const std::uint64_t index = sender.count++;
  if (!keep_truth) return;
  sender.sent.push_back({.index = index,
                         .exposure_begin = host_time(message.begin.time_ns),
                         .exposure_end = host_time(message.end.time_ns),
                         .mean_rate_dps = mean_rate_dps(message.begin, message.end),
                         .sent = host_time(sent_ns),
                         .span = span,
                         .arrives = span.size() == message.bytes.size()});
}

/// An answer goes out behind what the line carries by then.
void VirtualRig::Parts::heard(Device device, Sender& sender, const Heard& heard, std::int64_t time_ns) {
  sender.streams = (sender.streams || heard.asks_for_stream) && heard.asked == 0;
  sender.owed += heard.asked;
  if (device == Device::camera && heard.rate_hz) camera.set_output_rate(*heard.rate_hz);
  line_bytes.clear();
  sender.line.send(heard.answer, time_ns, line_bytes);
  pass_on(device, line_bytes);
}

/// A bridge whose line is still busy with the frame before leaves a frame out.
void VirtualRig::Parts::send_frames() {
  for (const SimulatedFrame& frame : camera.follow(shaft)) {
    const bool is_wanted = camera_sender.streams || camera_sender.owed > 0;
    if (!is_wanted || camera_sender.line.backlog_ns(frame.ready_ns) > 0) continue;
    if (camera_sender.owed > 0) --camera_sender.owed;
    send(Device::camera, camera_sender,
         {camera_encoder.bytes(frame, config.profile.camera), frame.ready_ns, frame.exposure_begin,
          frame.exposure_end});
  }
}

/// No sample: nothing of it is kept as truth.
void VirtualRig::Parts::send_idle(const SimulatedGyroSample& sample) {
  if (gyro_encoder.idle_bytes == nullptr) return;
  line_bytes.clear();
  gyro_sender.line.send(gyro_encoder.idle_bytes(sample, config.profile.gyro), sample.ready_ns, line_bytes);
  pass_on(Device::gyro, line_bytes);
}

void VirtualRig::Parts::send_gyro() {
  for (const SimulatedGyroSample& sample : gyro.follow(shaft)) {
    if (!gyro_sender.streams) {
      send_idle(sample);
      continue;
    }
    if (gyro_sender.line.backlog_ns(sample.ready_ns) > gyro_backlog_ns) continue;
    send(Device::gyro, gyro_sender,
         {gyro_encoder.bytes(sample, config.profile.gyro), sample.ready_ns, sample.begin, sample.end});
  }
}

VirtualRig::VirtualRig(const VirtualRigConfig& config, std::unique_ptr<Firmware> firmware)
    : parts_(std::make_unique<Parts>(config, std::move(firmware))) {}

VirtualRig::~VirtualRig() = default;

void VirtualRig::send(Device to, std::span<const std::uint8_t> bytes, HostTime now) {
  Parts& parts = *parts_;
  const std::int64_t now_ns = std::max(parts.now_ns, parts.rig_ns(now));
  const std::int64_t begin_ns = parts.paths[index_of(to)].outgoing_ns(now_ns);
  const RigProfile& profile = parts.config.profile;
  if (to == Device::servo)
    parts.servo.send(bytes, begin_ns);
  else if (to == Device::camera && parts.camera_encoder.hear != nullptr &&
           parts.config.camera_start != CameraStart::deaf)
    parts.heard(to, parts.camera_sender, parts.camera_encoder.hear(bytes, profile.camera), begin_ns);
  else if (to == Device::gyro && parts.gyro_encoder.hear != nullptr)
    parts.heard(to, parts.gyro_sender,
                parts.gyro_encoder.hear(bytes, profile.gyro, parts.config.gyro_start,
                                        parts.config.world.gyro.bandwidth_hz),
                begin_ns);
}

void VirtualRig::opened(Device device, HostTime now) {
  if (device == Device::servo) parts_->servo.opened(std::max(parts_->now_ns, parts_->rig_ns(now)));
}

std::vector<Chunk> VirtualRig::advance(HostTime until) {
  const std::int64_t until_ns = parts_->rig_ns(until);
  // An encoder looks at the shaft on a grid, wherever a call ends.
  const auto end_ns = [&](std::int64_t now_ns) {
    return parts_->encoder ? (now_ns / encoder_slice_ns + 1) * encoder_slice_ns : now_ns + slice_ns;
  };
  while (parts_->now_ns < until_ns) parts_->run_slice(std::min(end_ns(parts_->now_ns), until_ns));
  std::vector<Chunk> chunks;
  for (const Device device : all_devices)
    for (TimedBytes& read : parts_->paths[index_of(device)].reads(parts_->now_ns))
      chunks.push_back({device, parts_->host_time(read.time_ns), std::move(read.bytes)});
  std::stable_sort(chunks.begin(), chunks.end(),
                   [](const Chunk& left, const Chunk& right) { return left.arrived < right.arrived; });
  return chunks;
}

HostTime VirtualRig::when_servo_clock_read(ServoTime mcu) const {
  const auto mcu_us = static_cast<double>(mcu.time_since_epoch().count());
  return parts_->host_time(parts_->servo.clock().rig_ns_at(mcu_us));
}

const std::vector<TruthSample>& VirtualRig::shaft() const {
  return parts_->shaft_truth;
}
const std::vector<SentMessage>& VirtualRig::sent_frames() const {
  return parts_->camera_sender.sent;
}
const std::vector<SentMessage>& VirtualRig::sent_gyro() const {
  return parts_->gyro_sender.sent;
}
const std::vector<PulseEdge>& VirtualRig::pulses() const {
  return parts_->pulses;
}
void VirtualRig::keep_truth(bool keep) {
  parts_->keep_truth = keep;
}

}  // namespace thermorig::simulation
