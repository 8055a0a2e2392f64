// SPDX-License-Identifier: MIT
#include "thermorig/core/gyro_blocks.h"

#include <algorithm>

namespace thermorig {

void GyroBlock::add(const TimedGyro& sample) {
  const auto add_to = [](RunningStatistics& statistics, float rate_dps) {
    if (std::isfinite(rate_dps)) statistics.add(static_cast<double>(rate_dps));
  };
  add_to(shaft_dps, sample.rate_dps);
  for (std::size_t axis = 0; axis < axes_dps.size(); ++axis)
    add_to(axes_dps[axis], sample.reading.rate_dps[axis]);
}

double GyroBlock::largest_deviation_dps() const {
  double variance = shaft_dps.variance();
  for (const RunningStatistics& axis : axes_dps) variance = std::max(variance, axis.variance());
  return std::sqrt(variance);
}

std::span<const TimedGyro> between(std::span<const TimedGyro> gyro, HostTime begin, HostTime end) {
  const auto before = [](const TimedGyro& sample, HostTime time) { return sample.stamp.time < time; };
  const auto first = std::lower_bound(gyro.begin(), gyro.end(), begin, before);
  return {first, std::lower_bound(first, gyro.end(), std::max(begin, end), before)};
}

std::vector<GyroBlock> gyro_blocks(std::span<const TimedGyro> gyro, HostTime begin, HostTime end,
                                   const GyroBlocking& blocking) {
  std::vector<GyroBlock> blocks;
  const std::span<const TimedGyro> within = between(gyro, begin, end);
  for (auto sample = within.begin(); sample != within.end();) {
    if (sample->stamp.time >= begin + blocking.length) begin = sample->stamp.time;
    if (begin + blocking.length > end) break;
    GyroBlock block{.begin = begin, .shaft_dps = {}, .axes_dps = {}};
    begin += blocking.length;
    for (; sample != within.end() && sample->stamp.time < begin; ++sample)
      if (blocking.counts(*sample)) block.add(*sample);
    if (block.shaft_dps.count() >= blocking.fewest) blocks.push_back(block);
  }
  return blocks;
}

}  // namespace thermorig
