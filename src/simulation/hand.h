// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "thermorig/simulation/virtual_rig.h"

namespace thermorig::simulation {

/// The hand that turns the whole rig: its speed over each turn is a raised cosine, from rest to rest.
class Hand {
 public:
  /// Durations are positive. `start`: the host time at which rig time is 0.
  Hand(const std::vector<HandTurn>& turns, HostTime start);

  /// How far the rig has been turned by rig time `time_ns`, and how fast it turns.
  double angle_deg(std::int64_t time_ns) const;
  double rate_dps(std::int64_t time_ns) const;

 private:
  struct Turn {
    double begin_s, duration_s, angle_deg;
    double part(std::int64_t time_ns) const;  // of its duration, 0 to 1
  };
  std::vector<Turn> turns_;
};

}  // namespace thermorig::simulation
