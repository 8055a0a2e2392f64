// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "angle_track.h"
#include "thermorig/core/frame.h"
#include "thermorig/core/sample.h"

namespace thermorig::motion {

inline constexpr double whole_turn_deg = 360.0;

inline constexpr std::size_t half_pixels = frame_pixels / 2;
inline constexpr std::size_t half_rows = frame_rows / 2;  // pixels of one column in one chess half

/// A value for each pixel of a chess half, column after column (32, 12): what lies in one column looks into
/// one direction, and inner loops run over neighbours in memory. Aligned for vectors of four.
struct alignas(16) HalfPixels : std::array<float, half_pixels> {};

/// Row of pixel `k` of a column.
constexpr std::size_t row_of(std::size_t column, std::size_t k, unsigned parity) {
  return 2 * k + ((column ^ parity) & 1U);
}

/// A chess half of a frame that was read anew: when it was exposed and how fast the rig turned.
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
