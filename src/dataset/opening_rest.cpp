// SPDX-License-Identifier: MIT
#include "opening_rest.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "thermorig/session/servo_rests.h"

namespace thermorig::dataset {

namespace {

using session::Stretch;

/// Telemetry before the first leg.
std::span<const TimedServo> before_legs(std::span<const TimedServo> servo) {
  const auto first = std::find_if(servo.begin(), servo.end(),
                                  [](const TimedServo& message) { return message.state.leg != 0; });
  return servo.first(static_cast<std::size_t>(first - servo.begin()));
}

}  // namespace

OpeningRest opening_rest_of(const session::Session& session) {
  const std::vector<Stretch> rests = session::servo_rests(before_legs(session.servo));
  OpeningRest rest;
  double sum = 0.0;
  auto stretch = rests.begin();
  for (const TimedGyro& sample : session.gyro) {
    while (stretch != rests.end() && stretch->end <= sample.stamp.time) ++stretch;
    if (stretch == rests.end()) break;
    if (sample.stamp.time < stretch->begin || !std::isfinite(sample.rate_dps)) continue;
    sum += sample.rate_dps;
    ++rest.samples;
  }
  rest.bias_dps =
      rest.samples > 0 ? sum / static_cast<double>(rest.samples) : std::numeric_limits<double>::quiet_NaN();
  return rest;
}

}  // namespace thermorig::dataset
