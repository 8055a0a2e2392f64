// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "thermorig/core/chunk.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/raw_recording.h"
#include "thermorig/core/sync.h"
#include "thermorig/core/time.h"

namespace thermorig::timing {

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

/// All of them: one for each chunk that ends within or at the end of a message. `spans` are the messages in
/// the order of the stream, `device_s` their places on the device's clock.
std::vector<LatestBegin> latest_begins(const RawStream& received, std::span<const StreamSpan> spans,
                                       std::span<const double> device_s, std::uint32_t baud);

/// The earliest proof of each message's begin: its own inequality or one of a later byte of the stream, which
/// went over the wire after it, whichever is sharper. Bytes may have gone as fast as shortest_wire_time_s()
/// says. One a message of `spans` (in the order of the stream).
/// A message that no chunk covers gets the greatest HostTime.
std::vector<HostTime> earliest_proofs(const RawStream& received, std::span<const StreamSpan> spans,
                                      std::uint32_t baud);

/// Numbers messages of a device that sends at a steady rate and numbers nothing itself, lost ones counted,
/// over a whole recording. Late reads are none lost: only messages that never catch up are. `latest` is the
/// earliest proof of each message's begin (the least of its inequalities). First number 0. `suspect` may mark
/// messages before which bytes were lost or damaged: elsewhere a loss needs clear evidence. One number a
/// message, ascending.
std::vector<std::int64_t> number_messages(std::span<const HostTime> latest, std::span<const bool> suspect,
                                          double nominal_rate_hz);

/// A device's clock over a whole recording from one-way inequalities alone: the highest smooth curve below
/// all of them, sliding, degree 2, minus what even the fastest byte is expected to be late by. Robust to
/// outages, wandering clocks and a loaded host.
///
/// What is bounded is the device's steady instant: the one from which a message would begin `latency_s` later
/// if the device never dawdled. A device that computes now and then a little longer (a camera's bridge) only
/// begins later, so what was read proves it too.
/// Where for ten seconds nothing came within the largest constant delay of the curve, the wander that it is
/// allowed is doubled: it is the device's clock against the host's, which may be slewed.
/// `later_s` is proven: the sharpest of all inequalities, carried over by a clock that stays within
/// PortProfile::wander_ppm of its mean rate (to which a short recording adds what its mean rate is uncertain
/// by). `earlier_s` rests on PortProfile::largest_constant_delay_s: an inequality that holds the curve up is
/// late by no more than that, or by that and the longest silence on a link that sends on silence; between
/// such inequalities what the wander allows is added.
struct ArrivalClock {
  std::vector<TimeEstimate> times;  // of each message: when its first byte began, minus the latency
  ClockReport report;
};

/// `device_s`: of each message, ascending (number / nominal rate, or its own time). A step back in it (a
/// reset) starts a new epoch.
ArrivalClock fit_arrivals(std::span<const double> device_s, std::span<const LatestBegin> latest,
                          const PortProfile& link, double nominal_rate_hz);

}  // namespace thermorig::timing
