// SPDX-License-Identifier: MIT
#include "opening_rest.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace thermorig::dataset {

namespace {

constexpr auto coming_to_rest = std::chrono::seconds(1);

struct Stretch {
  HostTime begin{};
  HostTime end{};
};

bool stands_still(const ServoState& state) {
  return state.leg == 0 && state.rate_dps == 0.0 &&
         (state.motion == ServoMotion::holding || state.motion == ServoMotion::disarmed);
}

/// Stretches without motion before the first leg.
std::vector<Stretch> rests_before_legs(const std::vector<TimedServo>& servo) {
  std::vector<Stretch> rests;
  bool resting = false;
  for (const TimedServo& message : servo) {
    if (message.state.leg != 0) break;
    const bool still = stands_still(message.state);
    if (still && !resting) rests.push_back({message.stamp.time + coming_to_rest, message.stamp.time});
    if (still) rests.back().end = message.stamp.time;
    resting = still;
  }
  return rests;
}

}  // namespace

OpeningRest opening_rest_of(const session::Session& session) {
  const std::vector<Stretch> rests = rests_before_legs(session.servo);
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
