// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "thermorig/core/sample.h"
#include "thermorig/rig/sweep/plan.h"

namespace thermorig::rig {

/// Valid frames that one commanded speed has, of those that it needs. Signed.
struct SpeedQuota {
  double rate_dps = 0.0;
  int valid = 0;
  int wanted = 0;
  bool is_short() const;
};

/// A recording drives by labels that are made at once; those of its session, which know all of it, may find
/// so many frames fewer valid before a speed counts as short.
inline constexpr int quota_tolerance_frames = 2;

/// Counts valid frames by the speed and the direction that were really commanded: a leg that goes back and
/// forth fills both directions. A plan that drives a speed twice wants twice as many.
class ValidQuota {
 public:
  explicit ValidQuota(const SweepPlan& plan);

  /// A leg with this number has begun, at one of the plan's speeds.
  void leg(std::uint16_t number, double rate_dps);

  void sample(const LabelledSample& sample);

  /// Valid frames that this step of the plan still lacks, 0 if none: with the steps before it at the same
  /// speed it wants its share, and `spare` more.
  int missing(std::size_t step, int spare = 0) const;

  /// Ascending by speed.
  std::vector<SpeedQuota> speeds() const;

 private:
  std::vector<double> step_rates_dps_;
  std::vector<int> wanted_by_step_;       // up to and with each step, at its speed
  std::map<long, SpeedQuota> speeds_;     // by hundredths of deg/s, as the link counts
  std::map<std::uint16_t, double> legs_;  // magnitude by number
};

}  // namespace thermorig::rig
