// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "final_times.h"
#include "gyro_losses.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/sample.h"
#include "thermorig/pipeline/pipeline.h"
#include "thermorig/pipeline/timing/link_timing.h"
#include "thermorig/sensors/gyro_protocol.h"

namespace thermorig::pipeline {

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

  sensors::GyroScanner scanner_;
  timing::LinkTiming timing_;
  FinalTimes final_times_;
  GyroLosses losses_;
  wire::Counters counters_;
  std::size_t axis_;
  float sign_;
  bool was_away_ = false;                    // since the last sample
  std::vector<wire::GyroMessage> messages_;  // empty between calls; kept for its memory
};

}  // namespace thermorig::pipeline
