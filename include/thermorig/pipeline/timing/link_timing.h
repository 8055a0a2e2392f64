// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "thermorig/core/chunk.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"
#include "thermorig/core/wire_time.h"
#include "thermorig/pipeline/timing/live_clock.h"

namespace thermorig::timing {

/// What else is known of a message when it is stamped.
struct StampHint {
  bool lost_before = false;        // bytes were lost before it: messages may have been among them
  std::optional<double> device_s;  // its place on the device's own clock, if it sends one
};

/// Turns the arrival of chunks into the time of the messages in them; it never uses a chunk that has not
/// arrived.
///
/// What the bytes prove: a message whose bytes are span.begin .. span.end - 1 began no later than
///
///     arrival(C) - (C.end - span.begin) * 10 / baud
///
/// for every chunk C that ends within it or brings its last byte. Two things keep time from running
/// backwards: an arrival before the one of the chunk before counts as equal to it, and a message is never
/// stamped before the message before it.
///
/// Of a device with a steady rate a `LiveClock` draws the highest line below those proofs of the last
/// seconds; the message's time is on that line, less what even the fastest byte is expected to be late by
/// (chance, a wait for a USB frame, half of the longest silence that a CH340 may wait for), and never after
/// its own proof. Its uncertainty is that of what was taken off.
///
/// While that clock is too young, and of a device without a steady rate, the time is the proof by the chunk C
/// that brought the last byte. Its uncertainty is that of the last byte of C, which came at the earliest once
/// the chunk before had been read and C's bytes had gone over the wire, and at the latest when C was read: a
/// uniform spread over that slack, but over no more than `longest_hold_s`.
///
/// Bounds: `later_s` is proven, since the sample was taken before its message began. `earlier_s` rests on the
/// largest constant delay, or on `longest_hold_s`, and a busy host may break it. What no clock can know from
/// arrivals is in none of them: an error of the configured latency. Both have room for `baud_tolerance` of
/// the wire time that was taken off, which the uncertainty has not: it is a constant, as the latency is.
class LinkTiming {
 public:
  /// What a USB serial adaptor holds back at most: FTDI's latency timer as it comes (AN232B-04).
  static constexpr double longest_hold_s = 0.016;

  /// A message may end so many bytes before the newest chunk began (a scanner that goes back after a bad
  /// checksum finds such ones); chunks further back are forgotten, whether messages came out of them or not.
  static constexpr std::uint64_t history_bytes = 8192;

  /// `nominal_rate_hz`: of a device that sends messages at a steady rate, as far as one knows; 0 if it does
  /// not.
  explicit LinkTiming(const PortProfile& link, double nominal_rate_hz = 0.0);

  /// A chunk arrived whose last byte is at stream offset `end` - 1. Chunks come in order.
  void chunk(std::uint64_t end, HostTime arrived);

  /// When the first byte of `span` began, minus the latency. All chunks up to span.end must have been
  /// announced (a bug otherwise). Spans must come in order of their ends; older chunks are forgotten.
  Stamp stamp(const StreamSpan& span, const StampHint& hint = {});

  /// Messages that never came, as the clock of a device with a steady rate counts so far:
  /// LiveClock::missing().
  double missing() const { return clock_ ? clock_->missing() : 0.0; }

  /// From here on hints bring no device_s, or such of another clock.
  void forget_clock();

  /// The device was away: nothing that was learnt of its clock holds for what comes next.
  void restart();

 private:
  struct TimedChunk {
    std::uint64_t begin;
    std::uint64_t end;
    HostTime arrived;
    HostDuration since_before;  // since the arrival of the chunk before
  };
  double lost_before(const StreamSpan& span, const StampHint& hint) const;
  HostTime begin_before(const TimedChunk& chunk, const StreamSpan& span) const;
  void add_read(const TimedChunk& chunk, const StreamSpan& span);
  float uncertainty_s(const TimedChunk& chunk) const;

  PortProfile link_;
  double nominal_rate_hz_;
  double byte_s_;  // wire time of one byte
  HostDuration latency_;
  double constant_delay_s_;
  std::deque<TimedChunk> chunks_;
  std::uint64_t begin_ = 0;           // of the stream, or of what came since the device was away
  std::optional<LiveClock> clock_;    // of a device with a steady rate
  std::vector<LatestBegin> reads_;    // that ended at or within the newest message
  std::uint64_t last_end_ = 0;        // of the message before
  HostTime newest_{HostTime::min()};  // no message is stamped before it
};

}  // namespace thermorig::timing
