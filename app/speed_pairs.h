// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <map>
#include <vector>

namespace thermorig::app {

/// What is said of a speed in both directions; none where it was not driven in one.
template <typename Speed>
struct SpeedPair {
  const Speed* forward = nullptr;
  const Speed* backward = nullptr;
};

/// By magnitude, in hundredths of deg/s: a row each in tables of speeds. They must outlive the pairs.
template <typename Speed>
std::map<long, SpeedPair<Speed>> by_magnitude(const std::vector<Speed>& speeds) {
  std::map<long, SpeedPair<Speed>> pairs;
  for (const Speed& speed : speeds) {
    SpeedPair<Speed>& pair = pairs[std::lround(std::abs(speed.rate_dps) * 100)];
    (speed.rate_dps < 0 ? pair.backward : pair.forward) = &speed;
  }
  return pairs;
}

}  // namespace thermorig::app
