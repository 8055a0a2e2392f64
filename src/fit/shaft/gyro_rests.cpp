// SPDX-License-Identifier: MIT
#include "thermorig/fit/shaft/gyro_errors.h"

#include <algorithm>
#include <cmath>

#include "thermorig/core/gyro_blocks.h"

namespace thermorig::fit {

namespace {

constexpr auto still_block_length = std::chrono::milliseconds(250);
constexpr std::size_t fewest_in_block = 8;
constexpr double quietest_share = 0.1;  // of the blocks: their deviation is the gyro's noise
constexpr double still_factor = 2.0;    // a block that varies more is none of a rest
constexpr double least_noise_dps = 0.02;
constexpr double same_rest_dps = 0.5;  // a block's mean off that of the rest so far: the rig turns
constexpr double same_bias_dps = 1.0;  // by which a bias may drift until a later rest
constexpr double least_later_rest_s = 2.0;
constexpr std::size_t fewest_frames = 8;
constexpr std::size_t neighbour = 2;   // frames apart: both half-frames are new by then
constexpr double turned_factor = 1.5;  // noise differs as much however far apart, and is never so uneven

double noise_of(const std::vector<GyroBlock>& blocks) {
  std::vector<double> deviations;
  for (const GyroBlock& block : blocks) deviations.push_back(block.largest_deviation_dps());
  return std::max(upper_quantile(deviations, quietest_share), least_noise_dps);
}

/// Neighbouring still blocks of one mean; `rate_dps` is that.
std::vector<Interval> still_stretches(const std::vector<GyroBlock>& blocks, HostTime origin) {
  const double length_s = to_s(still_block_length), limit_dps = still_factor * noise_of(blocks);
  std::vector<Interval> stretches;
  std::size_t count = 0;
  for (const GyroBlock& block : blocks) {
    if (!(block.largest_deviation_dps() <= limit_dps)) continue;
    const double begin_s = to_s(block.begin - origin), mean_dps = block.mean_dps();
    const bool goes_on = !stretches.empty() && begin_s <= stretches.back().end_s + length_s / 2 &&
                         std::abs(mean_dps - stretches.back().rate_dps) <= same_rest_dps;
    if (!goes_on) {
      stretches.push_back({begin_s, begin_s + length_s, mean_dps, 0});
      count = 1;
      continue;
    }
    Interval& stretch = stretches.back();
    stretch.end_s = begin_s + length_s;
    stretch.rate_dps += (mean_dps - stretch.rate_dps) / static_cast<double>(++count);
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
  const HostTime origin = gyro.front().stamp.time;
  const std::vector<GyroBlock> blocks = gyro_blocks(gyro, origin, gyro.back().stamp.time + still_block_length,
                                                    {still_block_length, fewest_in_block});
  if (blocks.empty()) return {};
  std::vector<Interval> rests;
  for (const Interval& stretch : still_stretches(blocks, origin)) {
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

}  // namespace thermorig::fit
