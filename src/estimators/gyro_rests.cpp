// SPDX-License-Identifier: MIT
#include "gyro_rests.h"

#include <algorithm>
#include <cmath>

namespace thermorig::estimators {

namespace {

constexpr double block_s = 0.25;
constexpr double longest_pause_s = 0.25;  // between samples, within a rest
constexpr std::size_t fewest_samples = 4;
constexpr double largest_noise_dps = 0.5;                          // of a gyro of today: 0.05 to 0.3
constexpr double least_noise_dps = 0.02;                           // of steps of 0.06, if nothing else
constexpr double mean_slack_dps = 0.02;                            // a step of the gyro's counts is 0.06
constexpr HostDuration settling = std::chrono::milliseconds(500);  // of shaft and gyro after a stop

}  // namespace

bool has_settled(const Observation& observation, HostTime time) {
  return observation.still_since && time >= *observation.still_since + settling;
}

double RestBlock::noise_variance() const {
  return std::max(samples.sample_variance(), least_noise_dps * least_noise_dps);
}

std::optional<RestBlock> GyroRests::add(const TimedGyro& sample) {
  const HostTime time = sample.stamp.time;
  if (!is_rate(sample.rate_dps)) {
    interrupt();
    return std::nullopt;
  }
  if (!is_followed(time)) interrupt();
  std::optional<RestBlock> rest;
  if (begin_ && to_s(time - *begin_) >= block_s) rest = finish(to_s(time - *begin_));
  if (!begin_) begin_ = time;
  last_ = time;
  samples_.add(double{sample.rate_dps});
  is_zero_ = is_zero_ && sample.reading.is_zero();
  return rest;
}

bool GyroRests::is_followed(HostTime time) const {
  return last_ && time > *last_ && to_s(time - *last_) <= longest_pause_s;
}

std::optional<RestBlock> GyroRests::finish(double length_s) {
  const bool is_quiet = samples_.count() >= fewest_samples && !is_zero_ &&
                        samples_.sample_variance() <= largest_noise_dps * largest_noise_dps;
  const RestBlock block{length_s, samples_};
  begin_.reset();
  samples_ = {};
  is_zero_ = true;
  count_ = is_quiet ? count_ + 1 : 0;
  if (!is_quiet) return std::nullopt;
  blocks_[count_ % kept] = block;
  if (count_ < kept || !is_rest()) return std::nullopt;
  return blocks_[(count_ + 1) % kept];
}

/// The means of all that are kept are one, but for their noise.
bool GyroRests::is_rest() const {
  const auto [low, high] =
      std::minmax_element(blocks_.begin(), blocks_.end(),
                          [](const RestBlock& a, const RestBlock& b) { return a.mean_dps() < b.mean_dps(); });
  const double noise_dps = std::sqrt(low->mean_variance() + high->mean_variance());
  return high->mean_dps() - low->mean_dps() <= 4.0 * noise_dps + mean_slack_dps;
}

}  // namespace thermorig::estimators
