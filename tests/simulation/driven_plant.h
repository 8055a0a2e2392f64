// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "simulation/servo_plant.h"
#include "simulation/shaft.h"

namespace thermorig::simulation {

constexpr double step_s = 1e-9 * Shaft::step_ns;

struct Motion {
  std::vector<double> angle_deg;  // a value every 0.25 ms
  std::vector<double> rate_dps;

  double angle_at(double time_s) const { return angle_deg[static_cast<std::size_t>(time_s / step_s)]; }
  double rate_at(double time_s) const { return rate_dps[static_cast<std::size_t>(time_s / step_s)]; }
  std::vector<double> rates_between(double from_s, double to_s) const {
    return {rate_dps.begin() + std::lround(from_s / step_s), rate_dps.begin() + std::lround(to_s / step_s)};
  }
};

using Width = std::function<double(double time_s)>;  // 0: no pulse

inline Motion drive(ServoPlant& plant, const Width& width_us, double seconds) {
  Motion motion;
  for (std::int64_t step = 0; step < std::llround(seconds / step_s); ++step) {
    const std::int64_t begin_ns = step * Shaft::step_ns;
    const double width = begin_ns % 20'000'000 == 0 ? width_us(1e-9 * static_cast<double>(begin_ns)) : 0.0;
    if (width > 0.0) plant.pulse(begin_ns, width);
    plant.step(begin_ns);
    motion.angle_deg.push_back(plant.angle_deg());
    motion.rate_dps.push_back(plant.rate_dps());
  }
  return motion;
}

inline ServoProfile winch() {
  return {};
}

inline double width_of(double angle_deg) {
  return 1500.0 + angle_deg * 2000.0 / 2160.0;
}

}  // namespace thermorig::simulation
