// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "thermorig/rig/sweep/quota.h"

namespace thermorig::rig {

enum class SweepPhase : std::uint8_t {
  waiting,   // start() has not been called
  greeting,  // hello, configure, arm
  opening_rest,
  transit,  // to where the next leg starts
  leg,
  recovering,  // after a fault or reset: at rest, then armed again
  awaiting,    // at rest until a device that went is back
  closing_rest,
  halting,   // to rest and disarmed at the end of the plan
  stopping,  // on request
  done,
  by_hand,  // there is no servo: recorded for so long, whatever turns the rig
};
std::string name_of(SweepPhase phase);

/// Where the sweep stands: for the progress line.
struct SweepProgress {
  SweepPhase phase = SweepPhase::waiting;
  int leg = 0;  // of the plan, counted from 1; 0 before the first
  int leg_count = 0;
  double rate_dps = 0.0;                // commanded in this leg
  std::optional<double> next_rate_dps;  // of the leg after this one
  int frames = 0;                       // in this leg so far
  int frames_per_leg = 0;
  double done_share = 0.0;         // 0..1
  double eta_s = 0.0;              // from the plan, not from the elapsed time
  int repeated = 0;                // legs that had to be driven again
  int valid = 0;                   // valid frames so far at this speed, in its direction
  int valid_quota = 0;             // of so many; 0: no quota
  std::vector<SpeedQuota> speeds;  // of the whole plan, ascending
};

/// What interrupted the sweep, and how often.
struct SweepTrouble {
  std::string what;  // "the servo's watchdog tripped"
  std::string advice;
  int count = 0;
};

}  // namespace thermorig::rig
