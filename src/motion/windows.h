// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>
#include <vector>

#include "alignment.h"
#include "half_view.h"
#include "thermorig/core/sync.h"
#include "thermorig/motion/panorama_fit.h"

namespace thermorig::motion {

/// A minute or so of moving halves: short enough that the gyro's bias drifts evenly, long enough for a
/// panorama.
using Window = std::vector<FreshHalf>;

/// What turns, in windows of about a minute within which no gyro sample is missing. Of rests only a few
/// halves are kept: they say nothing about time, and what they repeat would drown what does. At most `most`
/// windows, evenly spread where there are more.
std::vector<Window> moving_windows(std::span<const FreshHalf> halves, std::size_t most);

/// The same for turns that may take long: windows overlap by half, so that a turn that one cuts is whole in
/// the next; more of the rests is kept, since what is seen at rest before and after a turn closes it best.
std::vector<Window> turning_windows(std::span<const FreshHalf> halves, std::size_t most);

/// Slower than that, images hardly change from one to the next.
inline constexpr double slowest_useful_dps = 10.0;
double fastest_dps(std::span<const FreshHalf> halves);

/// Fastest rates either way.
struct RateRange {
  double negative_dps = 0.0;
  double positive_dps = 0.0;
};
RateRange rates_of(std::span<const FreshHalf> halves);

/// The gyro's bias where it is known, else its mean rate: a servo's travel ends somewhere.
double likely_bias_dps(const AngleTrack& track, const GyroErrors& errors);

/// What is known about the parameters before images are looked at.
Prior prior_of(const GyroErrors& errors, double bias_dps);

Layout layout_of(const View& view, bool closed);

/// The offset at which the panorama is sharpest, on a coarse grid; the other parameters as the prior has
/// them.
Parameters search_offset(Alignment& alignment, const Prior& prior);

/// Beyond that offset a camera's halves cannot be told from their neighbours.
inline constexpr double largest_offset_s = 0.30;

}  // namespace thermorig::motion
