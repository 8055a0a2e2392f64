// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <vector>

#include "thermorig/core/raw_recording.h"
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
  std::optional<HostTime> left() const { return left_; }
  const LegRecord& record() const { return record_; }

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
  bool acknowledged_ = false;
  bool over_ = false;
  struct Counted {
    HostTime middle{}, arrival{};
  };
  std::vector<Counted> counted_;
  std::optional<HostTime> first_seen_, last_seen_;
  std::optional<HostTime> left_;
};

}  // namespace thermorig::rig
