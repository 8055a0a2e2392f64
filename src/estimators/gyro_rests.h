// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "thermorig/core/sample.h"
#include "thermorig/core/statistics.h"
#include "thermorig/estimators/estimator.h"

namespace thermorig::estimators {

/// By how much a bias wanders, a square root of a second: a consumer gyro's.
inline constexpr double bias_walk_dps = 0.005;

/// A quarter of a second of a gyro at rest: its mean is its bias, the spread of its samples is its noise.
struct RestBlock {
  double length_s = 0.0;
  RunningStatistics samples;
  double mean_dps() const { return samples.mean(); }
  double noise_variance() const;  // of one sample
  double mean_variance() const { return noise_variance() / static_cast<double>(samples.count()); }
};

/// Finds rests in what a gyro measures: a second in which it shows no more than noise and its mean does not
/// move. A speed that is constant looks the same: who knows what the servo is told, or the bias, must say
/// which it is.
class GyroRests {
 public:
  /// The next sample. A block is told of once three more have shown that the rest went on: what a motion
  /// begins with, be it slow, is in none. One in which a gyro sets itself to zero hides its bias, and is
  /// none.
  std::optional<RestBlock> add(const TimedGyro& sample);

  /// No rest reaches over this.
  void interrupt() { *this = GyroRests(); }

 private:
  static constexpr std::size_t kept = 4;
  bool is_followed(HostTime time) const;
  std::optional<RestBlock> finish(double length_s);
  bool is_rest() const;

  std::optional<HostTime> begin_, last_;  // of the block that is being filled
  RunningStatistics samples_;
  bool is_zero_ = true;                   // all samples of it about all axes
  std::array<RestBlock, kept> blocks_{};  // the last ones, in a ring
  std::size_t count_ = 0;
};

/// Whether the servo has been told to stand still for so long that its shaft and the gyro do.
bool has_settled(const Observation& observation, HostTime time);

}  // namespace thermorig::estimators
