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
#include "thermorig/pipeline/timing/link_timing.h"
#include "thermorig/pipeline/timing/ping_clock.h"

namespace thermorig::fit {

using timing::LatestBegin;

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

/// What timing::PingClock does, over a whole recording and non-causal: the times of `mcu_us`, and a report
/// with knots.
///
/// All three in the order of the stream; `mcu_us` are those of `sent` or some of them, and a step back of
/// more than 0.2 s in it is a reset. The wander that each epoch's bounds allow for is at least twice what
/// explains all of its messages, and more at both ends of the epoch, where the minute of the mean rate lies
/// to one side. ClockReport::bound_wander_ppm is the largest, and 0 where nothing explains them. In an epoch
/// without any exchange the bounds are those of a one-way clock: the lower end rests on
/// PortProfile::largest_constant_delay_s. Times that nothing bounds have infinite uncertainty.
struct PingFit {
  std::vector<TimeEstimate> times;
  ClockReport report;
};
PingFit fit_pings(std::span<const std::int64_t> mcu_us, std::span<const timing::PingBound> exchanges,
                  std::span<const timing::PingBound> sent, const PortProfile& link);

}  // namespace thermorig::fit
