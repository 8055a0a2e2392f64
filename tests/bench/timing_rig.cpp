// SPDX-License-Identifier: MIT
#include "timing_rig.h"

#include <array>
#include <chrono>
#include <iterator>
#include <utility>

#include "thermorig/rig/sweep/servo_commander.h"

namespace thermorig::bench {
namespace {

/// Steps of 3 to 5 ms, as the recorder's own in virtual time: no host keeps step with its USB frames.
class UnevenSteps {
 public:
  explicit UnevenSteps(std::uint64_t seed) : state_(seed) {}
  HostDuration next() {
    state_ = state_ * 6364136223846793005U + 1442695040888963407U;
    return std::chrono::microseconds(3000 + (state_ >> 33U) % 2001U);
  }

 private:
  std::uint64_t state_;
};

template <typename Value>
void move_to(std::vector<Value>& to, std::vector<Value>& from) {
  to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
}

/// The host: one loop that feeds the pipeline, answers the commander and writes what it says.
class Host {
 public:
  Host(const simulation::VirtualRigConfig& config, const std::vector<Leg>& legs)
      : commander_(config.profile.servo),
        pipeline_(config.profile),
        servo_(config.profile.servo),
        legs_(legs) {
    recorded_.rig = std::make_unique<simulation::VirtualRig>(config, simulation::make_host_firmware());
    recorded_.rig->keep_truth(true);
    recorded_.raw.header.profile = config.profile;
    recorded_.raw.header.simulated = true;
    recorded_.raw.header.time_reference = config.start;
    recorded_.raw.complete = true;
    commander_.greet();
    commander_.arm(0.0);
  }

  void step(HostTime now, double now_s) {
    for (const Chunk& chunk : recorded_.rig->advance(now)) receive(chunk);
    if (next_leg_ < legs_.size() && legs_[next_leg_].begin_s <= now_s && commander_.armed()) start_leg();
    const std::vector<std::uint8_t> bytes = commander_.poll(now);
    if (bytes.empty()) return;
    recorded_.rig->send(Device::servo, bytes, now);
    recorded_.raw.sent[Device::servo].append(bytes, now);
    pipeline_.sent(Device::servo, bytes, now);
  }

  Recorded finish(HostTime now) {
    pipeline_.finish();
    keep(pipeline_.take_streams());
    recorded_.raw.end_time = now;
    return std::move(recorded_);
  }

 private:
  void receive(const Chunk& chunk) {
    recorded_.raw.received[chunk.device].append(chunk.bytes, chunk.arrived);
    pipeline_.feed(chunk.device, chunk.bytes, chunk.arrived);
    pipeline::Streams streams = pipeline_.take_streams();
    for (const TimedPong& pong : streams.pongs) commander_.pong(pong);
    for (const wire::ServoMessage& message : streams.servo_answers) commander_.answer(message, chunk.arrived);
    keep(std::move(streams));
  }

  void keep(pipeline::Streams streams) {
    move_to(recorded_.live.frames, streams.frames);
    move_to(recorded_.live.gyro, streams.gyro);
    move_to(recorded_.live.servo, streams.servo);
    move_to(recorded_.live.pongs, streams.pongs);
    move_to(recorded_.live.servo_answers, streams.servo_answers);
  }

  void start_leg() {
    const Leg& leg = legs_[next_leg_++];
    commander_.run({.leg = static_cast<std::uint16_t>(next_leg_),
                    .turn_back = true,
                    .rate_dps = leg.rate_dps,
                    .acceleration_dps2 = servo_.acceleration_dps2,
                    .duration_s = leg.duration_s});
  }

  rig::ServoCommander commander_;
  pipeline::Pipeline pipeline_;
  ServoProfile servo_;
  const std::vector<Leg>& legs_;
  std::size_t next_leg_ = 0;
  Recorded recorded_;
};

}  // namespace

namespace {
std::string& world_name() {
  static std::string name = "honest";
  return name;
}
}  // namespace

void choose_world(const std::string& name) {
  world_name() = name;
}

const std::string& chosen_world() {
  return world_name();
}

simulation::VirtualRigConfig rig_in_world(std::uint64_t seed, const std::string& environment) {
  simulation::VirtualRigConfig config = simulation::default_rig(seed, environment);
  simulation::put_in_world(simulation::world_named(chosen_world(), seed), config);
  config.start = bench_start();
  return config;
}

std::string environment_of(std::size_t index) {
  constexpr std::array<const char*, 4> environments{"laboratory", "dining", "kitchen", "garden"};
  return environments[index % environments.size()];
}

HostTime bench_start() {
  return HostTime(std::chrono::seconds(100));
}

std::vector<TableLink> table_links(bool loaded) {
  using simulation::UsbLink;
  return {{"ftdi16", {.kind = UsbLink::ftdi, .latency_timer_s = 0.016, .loaded_host = loaded}},
          {"ftdi1", {.kind = UsbLink::ftdi, .latency_timer_s = 0.001, .loaded_host = loaded}},
          {"ch340", {.kind = UsbLink::ch340, .loaded_host = loaded}},
          {"cdc", {.kind = UsbLink::cdc, .loaded_host = loaded}}};
}

simulation::VirtualRigConfig rig_on(const TableLink& link, std::uint64_t seed) {
  simulation::VirtualRigConfig config = rig_in_world(seed, "laboratory");
  for (const Device device : all_devices) config.links[device] = link.config;
  if (link.config.kind == simulation::UsbLink::cdc)
    config.profile.camera.link.baud = config.profile.gyro.link.baud = 0;
  // A gyro's sample stands for the middle of its interval: that half is in the profile's latency, and not in
  // the board's, which counts from the interval's end.
  config.camera_latency_s = config.profile.camera.link.latency_s;
  config.gyro_latency_s = config.profile.gyro.link.latency_s - 0.5 / config.profile.gyro.output_rate_hz;
  return config;
}

Recorded record(const simulation::VirtualRigConfig& config, const std::vector<Leg>& legs, double duration_s) {
  Host host(config, legs);
  UnevenSteps steps(config.seed);
  HostTime now = config.start;
  while (to_s(now - config.start) < duration_s) {
    now += steps.next();
    host.step(now, to_s(now - config.start));
  }
  return host.finish(now);
}

}  // namespace thermorig::bench
