// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "sliding_fit.h"
#include "thermorig/core/estimate.h"
#include "thermorig/pipeline/timing/arrivals.h"

namespace thermorig::timing {

inline constexpr double usb_frame_s = 0.001;  // full-speed USB

/// How late even the fastest bytes are: what a curve below all inequalities cannot show, and the shape of the
/// lateness above it can.
struct LeastLateness {
  std::vector<Estimate> at_knots_s;  // to be taken off the curve
  double longest_hold_s = 0.0;       // beside the largest constant delay: a link that waits for silence
};

/// `x` (device seconds) and `late_s` (above the curve) of each of `latest`; `step_s`: between messages.
///
/// Three parts, each from the data:
///
/// 1. Chance. The fastest of some dozen messages is later than the least possible. Without the messages that
///    hold the curve up it would rise by about as much as it is too high already (the least of evenly spread
///    values is as far above their limit as the second least is above it).
///
/// 2. USB frames. A bridge's own timer and the host's 1 ms frames are two clocks that hardly slide against
///    each other, so a byte may wait for a frame nearly equally long for minutes: anything from 0 to 1 ms. As
///    much of that millisecond as the waits of the chunks cover, or as slides past within a window, is known
///    not to be such a constant; half of the rest is expected. Where chunks are cut off every millisecond it
///    may be the frame itself that cuts (USB-CDC) and makes no byte wait: half of the half.
///
/// 3. Silence. A link that sends when its line falls silent (`longest_silence_s`): half of the longest
/// silence.
LeastLateness least_lateness(std::span<const LatestBegin> latest, std::span<const double> x,
                             std::span<const double> late_s, double step_s,
                             std::span<const SlidingFit::Knot> knots, const SlidingWindow& window);

}  // namespace thermorig::timing
