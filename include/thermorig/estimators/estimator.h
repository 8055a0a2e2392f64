// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "thermorig/core/rate_estimate.h"
#include "thermorig/core/sample.h"
#include "thermorig/estimators/odometer/odometer.h"

namespace thermorig::estimators {

/// What an estimator is given of a measurement. Labels and the commanded speed are never among it: what is
/// judged cannot read the answer. Whatever its entry does not declare arrives blank.
struct Observation {
  std::uint64_t index = 0;  // of the measurement, from 0
  const TimedFrame& frame;  // times and gaps always; blank: no image, every pixel is NaN
  float gyro_mean_dps;      // over the frame's exposure, bias not removed; blank: NaN, as without a sample
  std::span<const TimedGyro> gyro;      // since the measurement before; blank: empty
  std::optional<HostTime> still_since;  // the servo is told to stand still, and has been since then; blank,
                                        // or it moves, or nothing is known: none
  bool is_told_to_move = false;         // by what the servo says of itself; blank: false
};

/// Follows the motion about the servo's axis, measurement by measurement: causal, deterministic, and without
/// an allocation in add().
class Estimator {
 public:
  virtual ~Estimator() = default;

  /// Nothing where it has nothing to say of this measurement, not even why.
  virtual std::optional<RateEstimate> add(const Observation& observation) = 0;

  /// With its map of the surroundings. Null where it keeps none.
  virtual const odometer::Odometer* odometer() const { return nullptr; }
};

}  // namespace thermorig::estimators
