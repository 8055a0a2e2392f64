// SPDX-License-Identifier: MIT
#include "servo_side.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "random.h"

namespace thermorig::simulation {
namespace {

constexpr double crystal_error = 30e-6;  // standard deviation
constexpr WanderLevel crystal_wander{.thermal_amplitude = 5e-6, .walk = 0.1e-6};

ClockDrift drift_of(const ServoClockWorld& world, std::uint64_t seed) {
  return {.warm_up = 1e-6 * world.warm_up_ppm,
          .wave = 1e-6 * world.wave_ppm,
          .wave_period_s = world.wave_period_s,
          .wave_phase_rad = Random(seed, "servo clock wave").uniform(0.0, 2.0 * std::numbers::pi)};
}

}  // namespace

McuClock::McuClock(std::uint64_t seed, const ServoClockWorld& world)
    : us_per_ns_(1e-3 * (1.0 + Random(seed, "servo clock").normal(crystal_error) + 1e-6 * world.error_ppm)),
      wander_(crystal_wander, seed, "servo clock wander", drift_of(world, seed)) {}

std::int64_t McuClock::us_at(std::int64_t rig_ns) {
  return static_cast<std::int64_t>(wander_.clock_ns(static_cast<double>(rig_ns)) * us_per_ns_);
}

std::int64_t McuClock::rig_ns_at(double us) {
  return static_cast<std::int64_t>(std::ceil(wander_.rig_ns(us / us_per_ns_)));
}

ServoSide::ServoSide(std::unique_ptr<Firmware> firmware, std::uint32_t baud, std::uint64_t seed,
                     const World& world)
    : firmware_(std::move(firmware)),
      clock_(seed, world.clock),
      toward_(baud, world.links.baud_error),
      byte_ns_(std::llround(toward_.byte_ns())),
      is_off_baud_(world.links.baud_error != 0.0) {}

void ServoSide::send(std::span<const std::uint8_t> bytes, std::int64_t begin_ns) {
  sending_.clear();
  toward_.send(bytes, begin_ns, sending_);
  coming_.insert(coming_.end(), sending_.begin(), sending_.end());
}

void ServoSide::run_firmware(std::int64_t mcu_us, Output& out) {
  FirmwareOutput step = firmware_->run_until(mcu_us);
  for (const UartByte& byte : step.bytes) {
    const std::int64_t end_ns = clock_.rig_ns_at(static_cast<double>(byte.time_us)) + byte_ns_;
    last_byte_ns_ = std::max(is_off_baud_ ? last_byte_ns_ + byte_ns_ : last_byte_ns_, end_ns);
    out.bytes.push_back({last_byte_ns_, byte.value});
  }
  out.pulses.insert(out.pulses.end(), step.pulses.begin(), step.pulses.end());
  out.writes.insert(out.writes.end(), step.writes.begin(), step.writes.end());
}

ServoSide::Output ServoSide::run_until(std::int64_t until_ns) {
  Output out;
  for (; !coming_.empty() && coming_.front().time_ns <= until_ns; coming_.pop_front()) {
    const std::int64_t mcu_us = clock_.us_at(coming_.front().time_ns);
    run_firmware(mcu_us, out);
    firmware_->receive(coming_.front().value, mcu_us);
  }
  run_firmware(clock_.us_at(until_ns), out);
  return out;
}

}  // namespace thermorig::simulation
