// SPDX-License-Identifier: MIT
#include "shaft_model.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "pulse_period.h"

namespace thermorig::labels {

namespace {
constexpr double decay = 0.7;             // damping, and for a first-order lag on the safe side
constexpr double to_one_percent = 4.605;  // -ln(0.01)
}  // namespace

double gain_at(const ServoResponse& response, const PulseScale& scale, double value) {
  const auto& gain = response.gain;
  if (gain.empty()) return 1.0;
  const double last = static_cast<double>(gain.size() - 1);
  // fmin and fmax: a value that is not a number has a place as well.
  const double place = std::fmax(0.0, std::fmin((scale.part(value) + 1.0) / 2.0 * last, last));
  const auto left = static_cast<std::size_t>(place);
  const std::size_t right = std::min(left + 1, gain.size() - 1);
  return std::lerp(gain[left], gain[right], place - static_cast<double>(left));
}

double settle_s(const ServoResponse& response) {
  const double loop_rad = 2.0 * std::numbers::pi * std::max(response.loop_hz, least_loop_hz);
  return std::max(response.delay_s, 0.0) + pulse_period_s + to_one_percent / (decay * loop_rad);
}

}  // namespace thermorig::labels
