// SPDX-License-Identifier: MIT
#include "servo_limits.h"

#include <gtest/gtest.h>

#include <cmath>

namespace thermorig::rig::test {

void expect_within_limits(const std::vector<simulation::PulseEdge>& pulses, const ServoProfile& servo) {
  constexpr double slack = 1.001;
  constexpr double step_us = 1.0 / 16.0;  // of a pulse
  const double deg_per_us = servo.travel_deg / (servo.pulse_max_us - servo.pulse_min_us);
  const double middle_us = (servo.pulse_min_us + servo.pulse_max_us) / 2.0;
  const double most_deg = servo.travel_deg / 2.0 - servo.stop_margin_deg + step_us * deg_per_us;
  const simulation::PulseEdge* before = nullptr;
  for (const simulation::PulseEdge& pulse : pulses) {
    ASSERT_LE(std::abs(pulse.width_us - middle_us) * deg_per_us, most_deg) << "at " << pulse.rise_us << " us";
    const double passed_s =
        before == nullptr ? 0.0 : 1e-6 * static_cast<double>(pulse.rise_us - before->rise_us);
    if (passed_s > 0.0 && passed_s < 0.03) {
      const double turned_deg = std::abs(pulse.width_us - before->width_us) * deg_per_us;
      ASSERT_LE(turned_deg, slack * servo.max_rate_dps * passed_s + 2.0 * step_us * deg_per_us)
          << "at " << pulse.rise_us << " us";
    }
    before = &pulse;
  }
  EXPECT_NE(before, nullptr);
}

}  // namespace thermorig::rig::test
