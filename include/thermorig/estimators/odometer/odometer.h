// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "thermorig/core/estimate.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/rate_estimate.h"
#include "thermorig/core/sample.h"
#include "thermorig/estimators/odometer/map.h"

namespace thermorig::odometer {

/// What is said when a frame has come, at the end of its exposure. As long as the map has not closed, its
/// degrees, which the lens makes, are as long as what the profile says of lens and gyro makes likeliest.
struct Report {
  // starting: bias and map are being learnt; good: it tracks, the heading is that of the map
  EstimateState state = EstimateState::starting;
  EstimateReason reason = EstimateReason::none;
  double heading_deg = unknown;  // since the map's origin; whole turns are counted
  // Against the part of the map that is in view; and where that map was begun anew, how well the gyro had
  // carried the heading there. Where that is in doubt, it also holds how far it is from what the gyro says.
  double heading_sigma_deg = unknown;
  double rate_dps = unknown;  // mean over the frame's exposures
  double rate_sigma_dps = unknown;
  double bias_dps = 0.0, scale = 1.0;     // of the gyro: reading = scale * rate + bias
  double latency_s = 0.0;                 // camera's middle rows against gyro, beyond what the profile says
  double innovation_deg = unknown;        // of the newest half that was compared with the map, once it tracks
  double innovation_sigma_deg = unknown;  // that was expected of it
  RowOrder rows = RowOrder::at_once;      // as the start has found them that ended last
  // By how much: logarithm of its likelihood over that of the best other order. 0: none has compared them.
  double row_margin = 0.0;
  double mean_nis = 0.0;  // innovations of late, squared, divided by what was expected of them: about 1
};

/// Heading from a gyro, a camera and a panorama of the surroundings that is built while the rig turns.
/// Causal and deterministic; after construction nothing is allocated, and the work of a frame is bounded.
class Odometer {
 public:
  /// `map`: of these surroundings, made before with such a lens; none: it makes one.
  Odometer(const GyroProfile& gyro, const CameraProfile& camera, std::shared_ptr<const Map> map = nullptr);
  ~Odometer();
  Odometer(Odometer&&) noexcept;
  Odometer& operator=(Odometer&&) noexcept;

  /// `gyro`: since the frame before, up to the end of this frame's exposure.
  Report add(const TimedFrame& frame, std::span<const TimedGyro> gyro);

  /// The map as it is, as an image in degrees Celsius: frame_rows rows from the top. Its columns are equal
  /// parts of a whole turn, begin at azimuth 0 and grow as angles do. NaN: never seen. Empty: no map yet. As
  /// long as it has not closed, its degrees are the lens's.
  std::vector<float> map_image_c() const;

  /// The map, for another one to begin with. Nothing before it tracks, and while the map is in doubt.
  std::optional<Map> map() const;

  /// What has become of the one that it began with.
  MapUse map_use() const;

  /// The order in which the camera exposes its rows, as the newest report has it.
  const FoundRows& rows() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace thermorig::odometer
