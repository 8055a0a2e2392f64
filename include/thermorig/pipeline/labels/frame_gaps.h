// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "thermorig/core/sample.h"
#include "thermorig/core/statistics.h"
#include "thermorig/core/time.h"
#include "thermorig/pipeline/labels/exposure.h"

namespace thermorig::labels {

/// What lies between a frame and the one before it. The camera numbers nothing, so two witnesses are heard:
/// the time, and, where the bridge renews one half of a frame at a time, which halves are fresh: the other
/// one after the frame before, the same or both after a frame that never came. A frame that repeats the one
/// before takes the place of its own: none is missing.
struct FrameGap {
  std::uint16_t missing = 0;  // frames that never came
  bool late = false;          // read more than half a period after it was due: its time is not known
};

/// Looks at a whole recording. A busy host delays reads, by seconds at times, and what queued up then comes
/// at once: such frames are late, none is missing. Frames are missing where the ones that follow never catch
/// up. `period_s` > 0: measured time between frames. One result a frame.
std::vector<FrameGap> find_gaps(const std::vector<TimedFrame>& frames, double period_s, CameraMode mode);

/// The same for a recording that goes on, from the past alone: what is late is called missing only when it
/// has stayed so for a few frames, without catching up.
class LiveFrameGaps {
 public:
  /// `frame_period_s` > 0: nominal; the measured one takes its place as soon as a few frames have come.
  explicit LiveFrameGaps(double frame_period_s);

  /// `frame`: its stamp is known. `halves`: what they say of the frames before it.
  FrameGap push(const TimedFrame& frame, HalvesWitness halves);

 private:
  void learn_period(HostTime time);
  bool catches_up(HostTime time) const;
  std::uint16_t missing(double late_periods, const TimedFrame& frame, HalvesWitness halves);

  static constexpr std::size_t kept_intervals = 15;
  double period_s_;
  std::optional<HostTime> before_;  // time of the frame before
  HostTime expected_{};
  std::size_t late_frames_ = 0;  // in a row
  RecentCount left_out_;         // frames that were never sent
  HostTime queue_begin_{};       // of the last frame ahead of those that came together
  std::size_t queue_length_ = 0;
  std::array<double, kept_intervals> intervals_s_{};
  std::size_t interval_count_ = 0;
};

/// Frames that an absence of the camera cost, between the last before it and the first after it: one at
/// least, so that no run goes on over it.
std::uint16_t missing_in_absence(HostTime last, HostTime first, double period_s);

}  // namespace thermorig::labels
