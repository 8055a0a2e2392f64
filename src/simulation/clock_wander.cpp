// SPDX-License-Identifier: MIT
#include "clock_wander.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace thermorig::simulation {
namespace {

constexpr double walk_time_s = 600.0;  // in which the walk is drawn back: a long run does not run away
constexpr double oscillator_warm_up_s = 120.0;

}  // namespace

double ClockDrift::at(double time_s) const {
  return warm_up * std::exp(-time_s / oscillator_warm_up_s) +
         wave * std::sin(wave_phase_rad + 2.0 * std::numbers::pi * time_s / wave_period_s);
}

ClockWander::ClockWander(const WanderLevel& level, std::uint64_t seed, std::string_view stream,
                         const ClockDrift& drift)
    : level_(level),
      drift_(drift),
      random_(seed, stream),
      wave_period_s_(random_.uniform(200.0, 900.0)),
      wave_phase_rad_(random_.uniform(0.0, 2.0 * std::numbers::pi)) {
  draw_second();
}

void ClockWander::draw_second() {
  const auto second = static_cast<double>(clock_ns_.size() - 1);
  const double wave_rad = wave_phase_rad_ + 2.0 * std::numbers::pi * second / wave_period_s_;
  walked_ = walked_ * std::exp(-1.0 / walk_time_s) + random_.normal(level_.walk);
  const double rate = 1.0 + level_.thermal_amplitude * std::sin(wave_rad) + walked_ + drift_.at(second);
  clock_ns_.push_back(clock_ns_.back() + second_ns * rate);
}

double ClockWander::clock_ns(double rig_ns) {
  const double second = std::max(0.0, std::floor(rig_ns / second_ns));  // before the start: its first rate
  const auto index = static_cast<std::size_t>(second);
  while (index + 1 >= clock_ns_.size()) draw_second();
  return clock_ns_[index] + rate_in(index) * (rig_ns - second * second_ns);
}

double ClockWander::rig_ns(double clock_ns) {
  while (clock_ns >= clock_ns_.back()) draw_second();
  const auto after = std::upper_bound(clock_ns_.begin() + 1, clock_ns_.end(), clock_ns);
  const auto index = static_cast<std::size_t>(after - clock_ns_.begin() - 1);
  return second_ns * static_cast<double>(index) + (clock_ns - clock_ns_[index]) / rate_in(index);
}

}  // namespace thermorig::simulation
