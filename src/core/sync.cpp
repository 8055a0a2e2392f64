// SPDX-License-Identifier: MIT
#include "thermorig/core/sync.h"

#include <algorithm>
#include <array>

namespace thermorig {

namespace {
constexpr double same_speed_dps = 0.5;  // pulses of a whole number of ticks command a speed roughly
constexpr std::array<std::string_view, 5> witness_names{"", "command", "gyro", "images", "undecided"};
}  // namespace

std::string_view name_of(Witness witness) {
  return witness_names[static_cast<std::size_t>(witness)];
}

Witness witness_named(std::string_view name) {
  const auto found = std::find(witness_names.begin(), witness_names.end(), name);
  return found == witness_names.end() ? Witness::none : static_cast<Witness>(found - witness_names.begin());
}

const ServoResponse::AtSpeed* seen_at(const ServoResponse& response, double commanded_dps) {
  const auto& speeds = response.speeds;
  const auto distance_dps = [&](const auto& speed) { return std::abs(speed.rate_dps - commanded_dps); };
  const auto nearest = std::min_element(speeds.begin(), speeds.end(), [&](const auto& a, const auto& b) {
    return distance_dps(a) < distance_dps(b);
  });
  return nearest != speeds.end() && distance_dps(*nearest) < same_speed_dps ? &*nearest : nullptr;
}

bool contradicts_command(const ServoResponse& response, double commanded_dps) {
  return std::any_of(response.speeds.begin(), response.speeds.end(), [&](const auto& speed) {
    return speed.contradicts && std::abs(speed.rate_dps - commanded_dps) < same_speed_dps;
  });
}

bool are_rows_apart(const CameraOffset& offset) {
  return offset.row_delay_s && contradict(*offset.row_delay_s, {0.0, 0.0});
}

double bias_dps_at(const GyroErrors& errors, HostTime time) {
  const std::vector<BiasKnot>& course = errors.bias_course;
  if (course.empty()) return errors.bias_dps ? errors.bias_dps->value : unknown;
  const auto next = std::lower_bound(course.begin(), course.end(), time,
                                     [](const BiasKnot& knot, HostTime at) { return knot.time < at; });
  if (next == course.begin()) return course.front().bias_dps;
  if (next == course.end()) return course.back().bias_dps;
  const BiasKnot& before = *(next - 1);
  const double share = to_s(time - before.time) / to_s(next->time - before.time);
  return std::lerp(before.bias_dps, next->bias_dps, share);
}

}  // namespace thermorig
