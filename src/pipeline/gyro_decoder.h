// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"
#include "thermorig/pipeline/final_times.h"
#include "thermorig/pipeline/pipeline.h"
#include "thermorig/pipeline/timing/device_time.h"
#include "thermorig/pipeline/timing/link_timing.h"
#include "thermorig/sensors/gyro_protocol.h"

namespace thermorig::pipeline {

/// How many samples of a gyro never came, as well as can be told while it goes on sending: no gyro numbers
/// its samples. By the steps of its own time where it sends one, else by the clock that counts at its steady
/// rate. That clock takes back what only came late, so a loss counts when it has stood for some seconds.
class GyroLosses {
 public:
  /// The next sample. `own_s`: by its own clock, if that is of use; `counted`: samples missing so far by the
  /// clock that counts, LinkTiming::missing().
  void sample(const Stamp& stamp, const std::optional<double>& own_s, double counted);

  /// The gyro is away, or its own times are of no use, and its clock forgotten: what it does not send
  /// meanwhile is not lost.
  void interrupt();

  std::uint64_t count() const { return before_ + settled_; }

 private:
  void look_at_step(HostTime time, double own_s);
  double usual_step_s() const;
  void settle(HostTime now, double missing);

  static constexpr std::size_t kept_steps = 15;
  std::array<double, kept_steps> steps_s_{};  // of its own time, the last ones
  std::size_t step_count_ = 0;
  std::optional<double> own_s_;  // of the sample before
  HostTime time_{};              // of the sample before
  double own_missing_ = 0.0;
  std::optional<HostTime> span_begin_;  // of the span in which `least_` is the least that was missing
  double least_ = 0.0;
  std::uint64_t settled_ = 0;
  std::uint64_t before_ = 0;  // the gyro was away
};

/// Gyro bytes to samples with their time and their rate about the servo's axis.
class GyroDecoder {
 public:
  GyroDecoder(const GyroProfile& profile, const Fits& fits);

  /// Appends the samples that the chunk completes to `out` and returns them.
  std::span<const TimedGyro> push(std::span<const std::uint8_t> chunk, HostTime arrived,
                                  std::vector<TimedGyro>& out);

  /// The stream has ended: the samples that waited for the bytes behind them.
  std::span<const TimedGyro> finish(std::vector<TimedGyro>& out);

  /// The gyro is away: what it sends from here on is another stream of a clock anew. Returns the samples that
  /// waited.
  std::span<const TimedGyro> interrupt(std::vector<TimedGyro>& out);

  /// Of the scanner. While it records, samples that never came count as lost; a second pass has the gaps that
  /// the first one found in the gyro's clock.
  const wire::Counters& counters() const { return counters_; }

 private:
  std::span<const TimedGyro> take(std::vector<TimedGyro>& out);
  timing::StampHint hint(const wire::GyroMessage& message);

  sensors::GyroScanner scanner_;
  timing::LinkTiming timing_;
  timing::OwnClock own_clock_;
  FinalTimes final_times_;
  GyroLosses losses_;
  wire::Counters counters_;
  std::size_t axis_;
  float sign_;
  bool was_away_ = false;                    // since the last sample
  HostTime arrived_{};                       // of the newest chunk
  std::vector<wire::GyroMessage> messages_;  // empty between calls; kept for its memory
};

}  // namespace thermorig::pipeline
