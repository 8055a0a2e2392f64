// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>

#include "thermorig/core/profile.h"
#include "thermorig/core/sync.h"
#include "thermorig/pipeline/labels/gyro_track.h"

namespace thermorig::labels {

/// What the profile says of the gyro.
GyroErrors assumed_gyro_errors(const GyroProfile& profile);

/// The gyro's bias from the rests so far, for whom the whole recording is not known: the median of the last
/// rests' means, so that a hand that turns the rig for a while does not move it.
class RunningBias {
 public:
  explicit RunningBias(const GyroErrors& assumed) : errors_(assumed) {}

  /// Gyro over a stretch in which the servo has long been at rest. Nothing but zeros says nothing: some gyros
  /// call whatever they measure at rest zero.
  void add(const GyroMean& rest);

  const GyroErrors& errors() const { return errors_; }

 private:
  static constexpr std::size_t kept = 63;
  void renew();

  GyroErrors errors_;
  std::array<double, kept> means_dps_{};
  std::array<double, kept> deviations_dps_{};
  std::size_t count_ = 0;
};

/// The gyro's noise while the shaft turns, from the frames so far, for whom the whole recording is not known:
/// gears that are heard by a gyro are heard in motion alone.
class MotionNoise {
 public:
  /// Gyro over an exposure in which the servo was moving.
  void add(const GyroMean& moving);

  /// Of a sample, deg/s; 0 before anything moved.
  double noise_dps() const;

 private:
  double square_dps2_ = 0.0;
  double weight_ = 0.0;
};

}  // namespace thermorig::labels
