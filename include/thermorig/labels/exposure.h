// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>

#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"
#include "thermorig/labels/freshness.h"

namespace thermorig::labels {

/// Says over which time a frame was exposed and whether it shows what it should.
///
/// The sensor exposes one chess half for a refresh period, then the other. With t the frame's stamp and P the
/// time between frames:
///
///     half-fresh: a refresh period is P;     the halves saw [t - 2P, t - P] and [t - P, t]
///     full-fresh: a refresh period is P / 2; the halves saw [t - P, t - P/2] and [t - P/2, t]
///
/// Where the mode is not given it is decided causally, frame by frame, by a ModeVote over the frames so far.
class ExposureRule {
 public:
  /// `frame_period_s` > 0: time between frames, nominal or measured.
  explicit ExposureRule(double frame_period_s, std::optional<CameraMode> mode = std::nullopt);

  /// Fills in fresh_even, fresh_odd, exposure_begin, exposure_end and stale of a frame whose temperatures and
  /// stamp are known. Frames come in order.
  ///
  /// stale: half-fresh: no half is fresh, or only one and the same one as the last time that only one was
  /// (the other half was lost); full-fresh: not both halves are fresh.
  void apply(TimedFrame& frame);

  /// The mode that the frame before was taken in.
  CameraMode mode() const { return mode_.value_or(vote_.mode()); }

 private:
  enum class Half : std::uint8_t { none, even, odd };
  bool is_stale(const Freshness& freshness);

  HostDuration frame_period_;
  std::optional<CameraMode> mode_;
  FreshnessDetector detector_;
  ModeVote vote_;
  Half last_single_ = Half::none;  // the half that alone was fresh, the last time that only one was
  bool first_ = true;
};

}  // namespace thermorig::labels
