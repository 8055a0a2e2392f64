// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/pipeline/labels/gyro_track.h"

namespace thermorig::labels {

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
