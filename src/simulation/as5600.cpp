// SPDX-License-Identifier: MIT
#include "as5600.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace thermorig::simulation {
namespace {

struct SlowFilter {
  double settling_s, noise_deg;
};
constexpr std::array slow_filters{SlowFilter{2.2e-3, 0.015}, SlowFilter{1.1e-3, 0.021},
                                  SlowFilter{0.55e-3, 0.030}, SlowFilter{0.286e-3, 0.043}};
constexpr std::uint8_t conf_high = 0x07;
constexpr double steps_a_turn = 4096.0;
constexpr double weak_noise = 2.0;  // times that of a good magnet: assumed
constexpr std::uint8_t magnet_found = 0x20, magnet_weak = 0x10;
constexpr std::uint8_t most_gain = 128;  // at 3.3 V; AGC stands in the middle of a good magnet

}  // namespace

As5600::As5600(const EncoderWorld& world, std::uint64_t seed)
    : world_(world),
      random_(seed, "encoder"),
      reversed_(random_.chance(0.5)),
      zero_deg_(random_.uniform(0.0, 360.0)),
      once_phase_rad_(random_.uniform(0.0, 2.0 * std::numbers::pi)),
      twice_phase_rad_(random_.uniform(0.0, 2.0 * std::numbers::pi)),
      gain_(static_cast<std::uint8_t>(random_.integer(48, 80))) {}

double As5600::measured_deg(double shaft_deg) const {
  const double turned_deg = (reversed_ ? -shaft_deg : shaft_deg) + zero_deg_;
  const double turned_rad = turned_deg * std::numbers::pi / 180.0;
  return turned_deg + world_.once_deg * std::sin(turned_rad + once_phase_rad_) +
         world_.twice_deg * std::sin(2.0 * turned_rad + twice_phase_rad_);
}

SensorRegisters As5600::look(const Shaft& shaft) {
  const SlowFilter& filter = slow_filters.at(slow_filter_);
  const bool weak = world_.weak_magnet >= 0.5;
  const auto lag_ns = std::llround(filter.settling_s / 2.0 * 1e9);
  const std::int64_t seen_ns = std::max<std::int64_t>(0, shaft.known_until_ns() - lag_ns);
  const double noise_deg = random_.normal(filter.noise_deg * (weak ? weak_noise : 1.0));
  const double angle_deg = measured_deg(shaft.angle_deg(seen_ns)) + noise_deg;
  const auto step = static_cast<std::int64_t>(std::floor(angle_deg / 360.0 * steps_a_turn));
  SensorRegisters registers;
  registers.raw = static_cast<std::uint16_t>(step & 0xFFF);
  registers.status = static_cast<std::uint8_t>(weak ? magnet_found | magnet_weak : magnet_found);
  registers.gain = weak ? most_gain : gain_;
  const bool fails = random_.chance(world_.failed_reads);
  const bool hangs = random_.chance(0.5);
  if (fails) registers.bus = hangs ? SensorBus::hangs_high : SensorBus::silent;
  return registers;
}

void As5600::take(std::span<const RegisterWrite> writes) {
  for (const RegisterWrite& write : writes)
    if (write.address == conf_high) slow_filter_ = write.value & 3U;
}

}  // namespace thermorig::simulation
