// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <numbers>
#include <span>
#include <vector>

#include "thermorig/core/estimate.h"
#include "thermorig/core/time.h"

namespace thermorig::timing {

inline constexpr double usb_frame_s = 0.001;  // full-speed USB

/// Windows are measured against a clock that wanders so much, and hold so many messages and blocks.
inline constexpr double reference_wander_ppm = 1000.0;
inline constexpr double messages_a_window = 40.0;
inline constexpr double blocks_a_window = 20.0;
/// Over a short segment a clock's mean rate is known no better than this, in time at either end.
inline constexpr double rate_slack_s = 0.005;

/// One inequality that a read chunk proves: the message at `device_s` on its device's clock had begun to be
/// sent by `latest`, since a later byte of it had arrived (arrival minus the wire time of the bytes up to
/// it).
struct LatestBegin {
  double device_s = 0.0;
  HostTime latest{};
  bool inside = false;  // the chunk ended within the message: the link cut it off while bytes were coming
  double wire_s = 0.0;  // wire time from the message's begin to the chunk's end: was taken off the arrival
  double held_s = 0.0;  // how long the link had kept the chunk's first byte by then, at least
};

/// A place of the curve, and how much higher it would be there without the messages that hold it up.
struct CurveRise {
  double x = 0.0;
  double rise = 0.0;
};

/// How late even the fastest bytes are: what a curve below all inequalities cannot show, and the shape of the
/// lateness above it can.
struct LeastLateness {
  std::vector<Estimate> at_knots_s;  // from the first knot that was asked for on: to be taken off the curve
  double longest_hold_s = 0.0;       // beside the largest constant delay: a link that waits for silence
};

/// Of the reads of one message, in their order. Each is as late above a curve as it was read: whatever the
/// curve, the same ones are the least and the quantile.
struct MessageReads {
  std::uint32_t count = 0;
  std::uint32_t cuts = 0;         // that ended within the message
  std::uint32_t short_holds = 0;  // of those: held for hardly longer than a USB frame
  std::uint32_t least = 0;        // the earliest read
  std::uint32_t least_cut = 0;    // the earliest cut, and the one that most cuts were read before
  std::uint32_t upper_cut = 0;
};

/// `reads` of one message.
MessageReads message_reads(std::span<const LatestBegin> reads);

/// What was read, and how late above a curve.
struct Reads {
  std::span<const LatestBegin> latest;
  std::span<const MessageReads> messages;  // that share all of `latest`, in order
  double x0 = 0.0;                         // on the device's clock: x = 0 of the curve
  std::function<double(std::size_t)> late_s;
};

/// `step_s`: between messages. `window_s`: over which the curve was drawn. Knots before `first_knot` get
/// nothing.
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
/// 3. Silence. A link that never cuts a message although its line is busy for a good part of the time sends
/// when that falls silent (CH340). How long it listens is constant and in no data sheet: anything up to the
/// pause between messages, or to 3 ms. Half of that is expected.
LeastLateness least_lateness(const Reads& reads, double step_s, std::span<const CurveRise> knots,
                             double window_s, std::size_t first_knot = 0);

/// Standard deviation of a uniform spread of width 1.
inline constexpr double uniform_deviation = 0.5 / std::numbers::sqrt3;

}  // namespace thermorig::timing
