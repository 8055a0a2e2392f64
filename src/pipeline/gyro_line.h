// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/core/sample.h"
#include "thermorig/timing/link_timing.h"
#include "thermorig/wire/gyro_scanner.h"

namespace thermorig::pipeline {

/// Gyro bytes to samples with their time and their rate about the servo's axis.
class GyroLine {
 public:
  explicit GyroLine(const GyroProfile& profile);

  /// Appends the samples that the chunk completes to `out` and returns them.
  std::span<const TimedGyro> push(std::span<const std::uint8_t> chunk, HostTime arrived,
                                  std::vector<TimedGyro>& out);

  const wire::Counters& counters() const { return scanner_.counters(); }

 private:
  wire::GyroScanner scanner_;
  timing::LinkTiming timing_;
  std::size_t axis_;
  float sign_;
  std::vector<wire::GyroMessage> messages_;  // empty between calls; kept for its memory
};

}  // namespace thermorig::pipeline
