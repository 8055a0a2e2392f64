// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <deque>

#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"

namespace thermorig::rig {

/// When the camera's frames come: how often, and where the next one lies.
class FrameSchedule {
 public:
  /// `nominal_rate_hz` > 0 stands until enough frames have come to measure it.
  explicit FrameSchedule(double nominal_rate_hz) : nominal_rate_hz_(nominal_rate_hz) {}

  void frame(const TimedFrame& frame);

  double rate_hz() const;

  /// How many of them come: fewer where a camera's bridge misses chess halves, so that a leg takes longer.
  double arrival_rate_hz() const { return rate_hz() * (came_ / (came_ + missed_)); }

  HostDuration period() const { return from_s(1.0 / rate_hz()); }

  /// Middle of the newest half's exposure of the frame after the latest. There must have been a frame.
  HostTime next_middle() const;

  /// About halfway between the middles of two frames; at any time before there is one.
  bool is_between_frames(HostTime now) const;

  /// From that middle to the frame's arrival, when nothing is late. There must have been a frame.
  HostDuration delay() const;

 private:
  struct Seen {
    HostTime middle{};
    HostTime arrival{};
    std::int64_t number = 0;  // those that never came are counted
  };
  double nominal_rate_hz_;
  std::deque<Seen> seen_;  // the latest ones
  double came_ = 1.0;      // of about the latest hundred
  double missed_ = 0.0;    // between them
};

/// Middle of the exposure of a frame's newest half: where its label finds the leg.
HostTime newest_middle(const TimedFrame& frame);

}  // namespace thermorig::rig
