// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "thermorig/core/surroundings/half_frame.h"
#include "thermorig/core/surroundings/turn_path.h"

namespace thermorig::motion {

/// A recording's gyro as it is, no bias, no scale taken into account: how far the rig has turned at any
/// instant, and where samples are missing.
class AngleTrack {
 public:
  explicit AngleTrack(std::span<const TimedGyro> gyro);

  /// Times in seconds since the first sample.
  const TurnPath& path() const { return path_; }
  double seconds(HostTime time) const { return to_s(time - origin_); }

  /// Over all samples.
  double mean_rate_dps() const;

  /// Number of the unbroken stretch of samples that covers the whole interval; none where samples are
  /// missing.
  std::optional<int> stretch(double begin_s, double end_s) const;

 private:
  struct Gap {  // from the last sample before it to the first one after it
    double begin_s = 0.0, end_s = 0.0;
  };
  HostTime origin_{};
  TurnPath path_;
  std::vector<Gap> gaps_;
};

/// A half-frame of a frame that was read anew: when it was exposed and how fast the rig turned.
struct FreshHalf {
  const TimedFrame* frame = nullptr;
  unsigned parity = 0;
  double begin_s = 0.0;  // of its exposure, on the angle track's clock
  double end_s = 0.0;
  double middle_s() const { return 0.5 * (begin_s + end_s); }
  double rate_dps = 0.0;         // by the gyro as it is, bias removed
  double rate_change_dps = 0.0;  // from the first third of the exposure to the last, without its sign
  int stretch = 0;               // of the gyro's samples
};

/// Which half of a full-fresh frame is exposed last, where that is a question and not known.
using NewerHalf = std::optional<unsigned>;

/// The halves that are fresh, whose time is known and around which the gyro was heard for `margin_s` on
/// either side, in order of the frames. With `newer`, only frames count both of whose halves are fresh, and
/// their exposures are dealt out anew.
std::vector<FreshHalf> fresh_halves(std::span<const TimedFrame> frames, const AngleTrack& track,
                                    double bias_dps, double margin_s, NewerHalf newer = std::nullopt);

/// The same halves, had the other one, `newer`, been exposed last.
std::vector<FreshHalf> dealt_anew(std::span<const FreshHalf> halves, const AngleTrack& track, unsigned newer);

/// What the surroundings looked like to one half.
struct HalfView {
  FreshHalf half;
  HalfPixels temp_c{};
  HalfPixels trust{};  // 0: no reading; 1: as good as the pixel is; in between: far from what it should be
};
std::vector<HalfView> views_of(std::span<const FreshHalf> halves);

}  // namespace thermorig::motion
