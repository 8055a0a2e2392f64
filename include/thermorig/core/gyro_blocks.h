// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "thermorig/core/sample.h"
#include "thermorig/core/statistics.h"

namespace thermorig {

/// What a gyro measured over a short time. At rest its mean is the bias, and its deviation is noise.
struct GyroBlock {
  HostTime begin{};
  RunningStatistics shaft_dps;                // about the servo's axis
  std::array<RunningStatistics, 3> axes_dps;  // x, y, z

  /// What is not finite is left out.
  void add(const TimedGyro& sample);

  double mean_dps() const { return shaft_dps.mean(); }
  double deviation_dps() const { return std::sqrt(shaft_dps.variance()); }  // of one sample
  double largest_deviation_dps() const;                                     // about any axis
};

/// Samples from `begin` to before `end`, of some in order of time.
std::span<const TimedGyro> between(std::span<const TimedGyro> gyro, HostTime begin, HostTime end);

/// How samples become blocks.
struct GyroBlocking {
  HostDuration length;
  std::size_t fewest = 1;                                                    // samples of a block
  bool (*counts)(const TimedGyro&) = [](const TimedGyro&) { return true; };  // others are left out
};

/// Blocks one after the other, whole ones, from `begin` to `end`. Behind a pause longer than a block they
/// begin anew with the next sample.
std::vector<GyroBlock> gyro_blocks(std::span<const TimedGyro> gyro, HostTime begin, HostTime end,
                                   const GyroBlocking& blocking);

}  // namespace thermorig
