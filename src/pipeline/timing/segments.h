// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "thermorig/pipeline/timing/arrivals.h"

namespace thermorig::timing {

/// Messages, and inequalities on them, that one curve explains.
struct Segment {
  std::size_t begin = 0;  // messages
  std::size_t end = 0;
  std::size_t latest_begin = 0;  // inequalities
  std::size_t latest_end = 0;
  bool new_epoch = false;  // the device's clock was reset before it
};

/// `device_s` without values that no clock shows (not finite, beyond a billion seconds): each of them is
/// replaced by the one before.
std::vector<double> clean_device_s(std::span<const double> device_s);

/// Splits where the device's clock steps back, and where it says nothing for longer than `longest_gap_s`:
/// over such a gap nothing carries, since the clock may have wandered and the count of what is missing is a
/// guess.
std::vector<Segment> find_segments(std::span<const double> device_s, std::span<const LatestBegin> latest,
                                   double longest_gap_s);

}  // namespace thermorig::timing
