// SPDX-License-Identifier: MIT
#include "virtual_sweep.h"

#include <iterator>
#include <utility>

#include "thermorig/sensors/wire/servo_messages.h"

namespace thermorig::pipeline {

namespace {
constexpr double step_s = 0.01;
constexpr int refresh_steps = 4;
constexpr int ping_steps = 10;
constexpr std::uint16_t ping_delay_max_us = 3000;
}  // namespace

VirtualSweep drive(const simulation::VirtualRigConfig& config, const std::vector<SweepLeg>& legs,
                   double duration_s) {
  simulation::VirtualRig rig(config, simulation::make_host_firmware());
  rig.keep_truth(true);
  VirtualSweep sweep{.config = config, .chunks = {}, .sent = {}, .frames = {}, .gyro = {}, .shaft = {}};
  std::uint32_t token = 0;
  const auto send = [&](const std::vector<std::uint8_t>& bytes, HostTime now) {
    rig.send(Device::servo, bytes, now);
    sweep.sent.append(bytes, now);
  };
  const auto script = tests::servo_script(config.profile.servo, legs);
  auto next = script.begin();
  for (int step = 0; step * step_s < duration_s; ++step) {
    const HostTime now(from_s(step * step_s));
    for (; next != script.end() && next->time_s <= step * step_s; ++next) send(next->bytes, now);
    if (step % refresh_steps == 0) send(wire::refresh_bytes(), now);
    if (step % ping_steps == 0) send(wire::ping_bytes(++token, ping_delay_max_us), now);
    auto chunks = rig.advance(now + from_s(step_s));
    std::move(chunks.begin(), chunks.end(), std::back_inserter(sweep.chunks));
  }
  sweep.frames = rig.sent_frames();
  sweep.gyro = rig.sent_gyro();
  sweep.shaft = rig.shaft();
  return sweep;
}

}  // namespace thermorig::pipeline
