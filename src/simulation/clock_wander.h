// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "random.h"

namespace thermorig::simulation {

/// How far an oscillator's rate strays: a wave with the room's temperature, and a random walk of the
/// frequency that is drawn back within about ten minutes. Relative figures.
struct WanderLevel {
  double thermal_amplitude;  // of a wave of 200 to 900 s
  double walk;               // standard deviation after a second
};

/// What an oscillator does beside that, without chance. Relative figures.
struct ClockDrift {
  double warm_up = 0.0;  // at the start; gone after minutes
  double wave = 0.0;     // amplitude
  double wave_period_s = 300.0;
  double wave_phase_rad = 0.0;

  double at(double time_s) const;
};

/// The time of a clock that wanders, against that of one that does not. The rate is new every second of rig
/// time and constant in between, so both directions are exact, increasing and each other's inverse; it is
/// drawn by the second, so nothing depends on who asks when. Times in nanoseconds, of any sign.
class ClockWander {
 public:
  ClockWander(const WanderLevel& level, std::uint64_t seed, std::string_view stream,
              const ClockDrift& drift = {});

  double clock_ns(double rig_ns);
  double rig_ns(double clock_ns);

 private:
  static constexpr double second_ns = 1e9;
  void draw_second();
  double rate_in(std::size_t second) const { return (clock_ns_[second + 1] - clock_ns_[second]) / second_ns; }

  WanderLevel level_;
  ClockDrift drift_;
  Random random_;
  double wave_period_s_;
  double wave_phase_rad_;
  double walked_ = 0.0;
  std::vector<double> clock_ns_{0.0};  // at each second of rig time
};

}  // namespace thermorig::simulation
