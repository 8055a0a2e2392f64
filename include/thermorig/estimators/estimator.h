// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "thermorig/core/rate_estimate.h"
#include "thermorig/core/sample.h"
#include "thermorig/estimators/odometer/map.h"

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

/// What an estimator has seen all around the servo's axis.
struct Surroundings {
  // Of frame_rows rows from the top, in degrees Celsius. The columns of a row are equal parts of a whole
  // turn: the first begins at the estimator's own angle 0, and they follow as its angle grows. NaN: never
  // seen.
  std::vector<float> image_c;
};

/// Follows the motion about the servo's axis, measurement by measurement: causal, deterministic, and without
/// an allocation in add().
class Estimator {
 public:
  virtual ~Estimator() = default;

  /// Nothing where it has nothing to say of this measurement, not even why.
  virtual std::optional<RateEstimate> add(const Observation& observation) = 0;

  /// Nothing where it keeps no image of them, or has none yet.
  virtual std::optional<Surroundings> surroundings() const { return std::nullopt; }

  /// What a later run may begin with. Nothing where it keeps no map, or none yet that it trusts.
  virtual std::optional<odometer::Map> map() const { return std::nullopt; }

  /// In which order the camera exposes its rows. Nothing where it does not ask, or not yet.
  virtual std::optional<odometer::FoundRows> rows() const { return std::nullopt; }

  /// What has become of the map that it began with.
  virtual odometer::MapUse map_use() const { return odometer::MapUse::none; }
};

}  // namespace thermorig::estimators
