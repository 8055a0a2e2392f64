// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "thermorig/core/raw_recording.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"

namespace thermorig::rig {

/// One leg, from its first command until its last frame has come. The frames that it counts are those whose
/// labels will name it for certain: close to either end that is left to the labels.
class DrivenLeg {
 public:
  DrivenLeg() = default;
  /// `planned`: frames that make it complete.
  DrivenLeg(const LegRecord& record, int planned, bool turn_back)
      : record_(record),
        planned_(planned),
        wanted_(planned),
        turn_back_(turn_back),
        run_rate_dps_(record.rate_dps) {}

  /// It is to have so many frames more than it was to have until now.
  void extend(int frames) { wanted_ += frames; }

  /// The command was acknowledged.
  void acknowledge(HostTime time);
  /// Modelled time of telemetry with this leg's number and without a fault.
  void seen(HostTime time);
  /// The servo has stopped of itself: frames behind the last telemetry that was seen do not count.
  void broke_off();
  /// The command after it was given.
  void leave(HostTime now) { left_ = now; }

  /// A frame that arrived, by the middle of its newest half's exposure. `doubt`: how far from an end of the
  /// leg it must lie to be counted.
  void frame(HostTime middle, HostTime arrival, HostDuration doubt);

  /// The frame that was counted last is another one, of the leg after this.
  void take_back();

  /// Nothing more will come: a frame behind its end has come, or it has all.
  bool is_over() const { return over_ || missing() <= 0; }
  bool is_whole() const { return record_.frames >= planned_; }
  int missing() const { return wanted_ - record_.frames; }

  bool acknowledged() const { return acknowledged_; }
  bool turn_back() const { return turn_back_; }
  const LegRecord& record() const { return record_; }

  /// The RUN command that was sent last ends then.
  void run_until(HostTime time) { run_ends_ = time; }
  HostTime run_ends() const { return run_ends_; }
  double run_rate_dps() const { return run_rate_dps_; }
  /// On its way back the servo must not be turned round once more: a renewed RUN keeps its direction.
  void keep_direction(double driven_dps);

  /// The record to keep, as of `now`.
  LegRecord closed(HostTime now) const;

 private:
  void note_counted();

  LegRecord record_;
  int planned_ = 0;
  int wanted_ = 0;
  bool turn_back_ = false;
  double run_rate_dps_ = 0.0;
  HostTime run_ends_{};
  bool acknowledged_ = false;
  bool over_ = false;
  struct Counted {
    HostTime middle{}, arrival{};
  };
  std::vector<Counted> counted_;
  std::optional<HostTime> first_seen_, last_seen_;
  std::optional<HostTime> left_;
};

/// A leg behind its end, while its last frame is still on its way. Where a frame is lost, a clock that knows
/// the past alone takes the next one for it, read late: halfway between the arrivals of the two, the later is
/// doubted. It is the last one after all if one more comes in time.
class LeftLeg {
 public:
  LeftLeg(const DrivenLeg& leg, HostTime left) : leg_(leg), left_(left) { leg_.leave(left); }

  /// The same as DrivenLeg::frame(). `delay`: from a frame's middle to its arrival, when nothing is late.
  void frame(HostTime middle, HostTime arrival, HostDuration doubt, HostDuration delay);

  /// Nothing more will come.
  bool is_settled() const { return leg_.is_over() && !last_is_late_; }
  HostTime left() const { return left_; }
  /// The leg as it is, without a last frame that is doubted.
  DrivenLeg settled() const;

 private:
  DrivenLeg leg_;
  HostTime left_;
  int frames_ = 0;             // since it was left
  bool last_is_late_ = false;  // what was counted as its last frame may be the one after
};

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
