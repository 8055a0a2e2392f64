// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"
#include "thermorig/labels/freshness.h"

namespace thermorig::labels {

/// Finds frames that never came. The camera numbers nothing, so two witnesses are heard: the time, against a
/// schedule that follows the earliest arrivals (a read that a busy host delays is late, not lost, and the
/// next one is on time again), and, where one half of a frame is fresh, which half: the halves take turns, so
/// an odd number is missing exactly where the same half comes twice.
class FrameGaps {
 public:
  /// `frame_period_s` > 0: time between frames. If it is only nominal, the measured one takes its place as
  /// soon as a few frames have come.
  FrameGaps(double frame_period_s, bool measured);

  /// How many frames are missing between the frame before and this one, whose stamp and freshness are known.
  unsigned push(const TimedFrame& frame, CameraMode mode);

 private:
  enum class Half : std::uint8_t { unknown, even, odd };
  static Half fresh_half(const TimedFrame& frame, CameraMode mode);
  unsigned missing(double late_periods, Half half) const;
  void learn_period(HostTime time);

  static constexpr std::size_t kept_intervals = 15;
  double period_s_;
  bool measured_;
  std::optional<HostTime> before_;
  HostTime expected_{};
  Half half_before_ = Half::unknown;
  std::array<double, kept_intervals> intervals_s_{};
  std::size_t interval_count_ = 0;
};

}  // namespace thermorig::labels
