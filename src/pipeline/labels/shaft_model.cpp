// SPDX-License-Identifier: MIT
#include "shaft_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pulse_period.h"

namespace thermorig::labels {

namespace {
constexpr double decay = 0.7;             // damping, and for a first-order lag on the safe side
constexpr double to_one_percent = 4.605;  // -ln(0.01)
}  // namespace

double settle_s(const ServoResponse& response) {
  const double loop_rad = 2.0 * std::numbers::pi * std::max(response.loop_hz, least_loop_hz);
  return std::max(response.delay_s, 0.0) + pulse_period_s + to_one_percent / (decay * loop_rad);
}

}  // namespace thermorig::labels
