// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/labels/gyro_rests.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "thermorig/core/statistics.h"

namespace thermorig::labels {

namespace {

constexpr double still_block_s = 0.25;
constexpr double quietest_share = 0.1;  // of the blocks: their deviation is the gyro's noise
constexpr double still_factor = 2.0;    // a block that varies more is none of a rest
constexpr double least_noise_dps = 0.02;
constexpr double same_rest_dps = 0.5;  // a block's mean off that of the rest so far: the rig turns
constexpr double same_bias_dps = 1.0;  // by which a bias may drift until a later rest
constexpr double least_later_rest_s = 2.0;
constexpr std::size_t fewest_frames = 8;
constexpr std::size_t neighbour = 2;   // frames apart: both chess halves are new by then
constexpr double turned_factor = 1.5;  // noise differs as much however far apart, and is never so uneven

struct StillBlock {
  double begin_s = 0.0;
  double mean_dps = 0.0;       // about the servo's axis
  double deviation_dps = 0.0;  // of the axis that varies most
};

StillBlock still_block(std::span<const TimedGyro> gyro, double begin_s) {
  RunningStatistics shaft;
  std::array<RunningStatistics, 3> axes;
  for (const TimedGyro& sample : gyro) {
    const auto add = [](RunningStatistics& statistics, float rate_dps) {
      if (std::isfinite(rate_dps)) statistics.add(static_cast<double>(rate_dps));
    };
    add(shaft, sample.rate_dps);
    for (std::size_t axis = 0; axis < axes.size(); ++axis) add(axes[axis], sample.reading.rate_dps[axis]);
  }
  double variance = shaft.variance();
  for (const RunningStatistics& axis : axes) variance = std::max(variance, axis.variance());
  return {begin_s, shaft.mean(), std::sqrt(variance)};
}

/// Without those that have hardly a sample.
std::vector<StillBlock> still_blocks(std::span<const TimedGyro> gyro) {
  constexpr std::size_t fewest_samples = 8;
  std::vector<StillBlock> blocks;
  const HostTime origin = gyro.front().stamp.time;
  const auto block_number = [&](const TimedGyro& sample) {
    return std::floor(to_s(sample.stamp.time - origin) / still_block_s);
  };
  for (std::size_t first = 0; first < gyro.size();) {
    const double number = block_number(gyro[first]);
    std::size_t end = first + 1;
    while (end < gyro.size() && block_number(gyro[end]) == number) ++end;
    if (end - first >= fewest_samples)
      blocks.push_back(still_block(gyro.subspan(first, end - first), number * still_block_s));
    first = end;
  }
  return blocks;
}

double noise_of(const std::vector<StillBlock>& blocks) {
  std::vector<double> deviations;
  for (const StillBlock& block : blocks) deviations.push_back(block.deviation_dps);
  return std::max(upper_quantile(deviations, quietest_share), least_noise_dps);
}

/// Neighbouring still blocks of one mean; `rate_dps` is that.
std::vector<Interval> still_stretches(const std::vector<StillBlock>& blocks) {
  std::vector<Interval> stretches;
  const double limit_dps = still_factor * noise_of(blocks);
  std::size_t count = 0;
  for (const StillBlock& block : blocks) {
    if (!(block.deviation_dps <= limit_dps)) continue;
    const bool goes_on = !stretches.empty() && block.begin_s <= stretches.back().end_s + still_block_s / 2 &&
                         std::abs(block.mean_dps - stretches.back().rate_dps) <= same_rest_dps;
    if (!goes_on) {
      stretches.push_back({block.begin_s, block.begin_s + still_block_s, block.mean_dps, 0});
      count = 1;
      continue;
    }
    Interval& stretch = stretches.back();
    stretch.end_s = block.begin_s + still_block_s;
    stretch.rate_dps += (block.mean_dps - stretch.rate_dps) / static_cast<double>(++count);
  }
  return stretches;
}

/// The median over the pixels of the squared difference of two frames, apart from what all pixels share: the
/// sensor's own temperature.
double difference_c2(const ThermalFrame& a, const ThermalFrame& b) {
  std::vector<double> differences;
  differences.reserve(frame_pixels);
  for (std::size_t i = 0; i < frame_pixels; ++i)
    if (const double difference_c = static_cast<double>(a.temp_c[i]) - static_cast<double>(b.temp_c[i]);
        std::isfinite(difference_c))
      differences.push_back(difference_c);
  if (differences.empty()) return 0.0;
  const double shared_c = median(differences);
  for (double& difference_c : differences)
    difference_c = (difference_c - shared_c) * (difference_c - shared_c);
  return reordering_median(differences);
}

/// Over pairs of frames that lie so far apart.
double usual_difference_c2(std::span<const TimedFrame> frames, std::size_t apart) {
  std::vector<double> differences;
  for (std::size_t i = 0; i + apart < frames.size(); ++i)
    differences.push_back(difference_c2(frames[i].frame, frames[i + apart].frame));
  return median(std::move(differences));
}

}  // namespace

std::vector<Interval> rests_by_gyro(std::span<const TimedGyro> gyro) {
  if (gyro.empty()) return {};
  const std::vector<StillBlock> blocks = still_blocks(gyro);
  if (blocks.empty()) return {};
  std::vector<Interval> rests;
  for (const Interval& stretch : still_stretches(blocks)) {
    const double length_s = stretch.end_s - stretch.begin_s;
    if (rests.empty()) {
      if (stretch.begin_s > latest_opening_rest_s) break;
      if (length_s >= least_opening_rest_s) rests.push_back(stretch);
    } else if (length_s >= least_later_rest_s &&
               std::abs(stretch.rate_dps - rests.front().rate_dps) <= same_bias_dps) {
      rests.push_back(stretch);
    }
  }
  return rests;
}

bool are_images_still(std::span<const TimedFrame> frames, HostTime begin, HostTime end) {
  const auto first = std::find_if(frames.begin(), frames.end(),
                                  [&](const TimedFrame& frame) { return frame.exposure_begin >= begin; });
  const auto last =
      std::find_if(first, frames.end(), [&](const TimedFrame& frame) { return frame.exposure_end > end; });
  const std::span<const TimedFrame> seen(first, last);
  if (seen.size() < fewest_frames) return true;
  const double most_c2 = turned_factor * turned_factor * usual_difference_c2(seen, neighbour);
  // Several, as what is seen may come round after one of them.
  for (const std::size_t quarters : {1U, 2U, 3U})
    if (usual_difference_c2(seen, seen.size() * quarters / 4) > most_c2) return false;
  return true;
}

}  // namespace thermorig::labels
