// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "thermorig/core/sample.h"
#include "thermorig/core/sync.h"
#include "thermorig/core/time.h"

namespace thermorig::fit {

/// The angle that the corrected gyro has turned by, over a whole recording. Each sample stands for the time
/// up to halfway to its neighbours.
class GyroIntegral {
 public:
  /// Whether a mean over saturated samples is a number: the least that the rate can be.
  enum class Saturated : std::uint8_t { spoils, counts };

  /// Times count in seconds from `origin`. Saturated samples and holes are remembered.
  GyroIntegral(std::span<const TimedGyro> gyro, const GyroErrors& errors, HostTime origin,
               Saturated saturated = Saturated::spoils);

  /// Mean rate over [begin_s, end_s], begin_s < end_s; not a number where a sample is missing or saturated or
  /// the recording does not reach.
  double mean_dps(double begin_s, double end_s) const {
    std::size_t near = 0;
    return mean_dps(begin_s, end_s, near);
  }
  /// `near`: see first_after().
  double mean_dps(double begin_s, double end_s, std::size_t& near) const;

  /// Median time between samples; 0 if there are fewer than two.
  double period_s() const { return period_s_; }
  const std::vector<double>& times_s() const { return times_s_; }

 private:
  struct Edge {
    double time_s;
    double angle_deg;
    std::uint32_t bad;  // bad samples so far
  };
  double angle_deg(std::size_t edge, double time_s) const;

  std::vector<double> times_s_;
  std::vector<Edge> edges_;
  double period_s_ = 0.0;
};

}  // namespace thermorig::fit
