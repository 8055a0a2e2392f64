// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "half_view.h"

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

}  // namespace thermorig::motion
