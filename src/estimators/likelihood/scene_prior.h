// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "thermorig/core/frame.h"

namespace thermorig::likelihood {

// Lengths are in pitches of a pixel, speeds in pitches an exposure. A line is what one row of pixels shows in
// one half-frame: every second pixel of it.

inline constexpr std::size_t line_pixels = frame_columns / 2;
inline constexpr std::size_t half_rows = frame_rows / 2;

/// What two pixels of a row have in common, of a scene of unit variance, while the camera turns at a constant
/// speed. `distance`: between the middles of what they sweep; `speed`: what each sweeps, either sign.
double swept_covariance(double distance, double speed);

/// Where in the scene a pixel's sweep has its middle, from where column 0 looks in the middle of the window.
/// `half`: of so many halves, the oldest is 0. The line begins with column 0 in the oldest half, with column
/// 1 in the next one.
double place_of(std::size_t half, std::size_t halves, std::size_t pixel, double speed);

}  // namespace thermorig::likelihood
