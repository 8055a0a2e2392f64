// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "gyro_integral.h"
#include "least_squares.h"
#include "thermorig/core/auto_zero.h"
#include "thermorig/core/gyro_blocks.h"
#include "thermorig/core/statistics.h"
#include "thermorig/fit/shaft/gyro_errors.h"
#include "thermorig/fit/shaft/intervals.h"
#include "thermorig/pipeline/labels/running_bias.h"

namespace thermorig::fit {

namespace {
constexpr auto block_length = std::chrono::milliseconds(250);
constexpr std::size_t least_samples = 8;   // of a block
constexpr double steady = 2.0;             // a block's deviation over that of most: the shaft moved
constexpr double outlying_block = 6.0;     // a block's mean off that of most: a hand turned the rig
constexpr double least_outlier_dps = 0.5;  // a bias wanders by as much
constexpr std::size_t long_rest_blocks = 4;
constexpr double least_uncertainty_dps = 0.01;
constexpr double unseen_drift_dps = 0.05;  // of a bias that was seen at one end of the recording alone
constexpr double servo_scale_doubt = 0.015;
constexpr double leg_deviation = 0.004;  // relative: a servo's slope along its travel
constexpr double leg_deviation_dps = 0.1;

/// A block of a rest.
struct Block {
  std::size_t rest = 0;  // its number
  GyroBlock gyro;
};

bool is_measured(const TimedGyro& sample) {
  return !sample.reading.is_zero();
}

bool zeroes_itself(std::span<const TimedGyro> gyro, const std::vector<Interval>& rests, HostTime origin) {
  AutoZero zeros;
  for (const Interval& rest : rests) {
    zeros.pause();
    for (const TimedGyro& sample : between(gyro, origin + from_s(rest.begin_s), origin + from_s(rest.end_s)))
      zeros.add(sample.reading);
  }
  return zeros.is_seen();
}

/// Blocks in the rests, each rest without the time that the shaft needs to settle.
std::vector<Block> blocks_of(std::span<const TimedGyro> gyro, const std::vector<Interval>& rests,
                             HostTime origin) {
  std::vector<Block> blocks;
  for (std::size_t rest = 0; rest < rests.size(); ++rest) {
    const HostTime begin = origin + from_s(rests[rest].begin_s + settled_after_s);
    for (const GyroBlock& block : gyro_blocks(gyro, begin, origin + from_s(rests[rest].end_s),
                                              {block_length, least_samples, is_measured}))
      blocks.push_back({rest, block});
  }
  return blocks;
}

template <typename Of>
std::vector<double> each(const std::vector<Block>& blocks, Of of) {
  std::vector<double> values;
  values.reserve(blocks.size());
  for (const Block& block : blocks) values.push_back(of(block));
  return values;
}

double mean_of(const Block& block) {
  return block.gyro.mean_dps();
}
double deviation_of(const Block& block) {
  return block.gyro.deviation_dps();
}

/// Blocks that are not further from the middle of their rest, or of most rests where theirs is short, than
/// blocks usually are.
void keep_usual(std::vector<Block>& blocks) {
  const double centre_dps = median(each(blocks, mean_of));
  std::map<std::size_t, std::vector<double>> by_rest;
  for (const Block& block : blocks) by_rest[block.rest].push_back(mean_of(block));
  std::map<std::size_t, double> centres;
  std::vector<double> off;
  for (const auto& [rest, means] : by_rest)
    centres[rest] = means.size() < long_rest_blocks ? centre_dps : median(means);
  for (const Block& block : blocks) off.push_back(mean_of(block) - centres[block.rest]);
  const double limit_dps = std::max(outlying_block * robust_deviation(off, 0.0), least_outlier_dps);
  std::erase_if(
      blocks, [&](const Block& block) { return std::abs(mean_of(block) - centres[block.rest]) > limit_dps; });
}

/// Leaves out what a moving shaft or a hand on the rig made: blocks that vary, and those far from most of
/// their rest. A bias may move from one rest to the next: a whole rest of some length is never left out.
void keep_quiet(std::vector<Block>& blocks) {
  const double noise_dps = median(each(blocks, deviation_of));
  std::erase_if(blocks, [&](const Block& block) { return deviation_of(block) > steady * noise_dps; });
  keep_usual(blocks);
}

/// Of the rests from number `first` to before `end`.
std::optional<double> bias_of_rests(const std::vector<Block>& blocks, std::size_t first, std::size_t end) {
  std::vector<double> means;
  for (const Block& block : blocks)
    if (first <= block.rest && block.rest < end) means.push_back(mean_of(block));
  return means.empty() ? std::nullopt : std::optional(median(std::move(means)));
}

/// How many of the rests begin before the first leg: the opening rest, and the one behind the drive to where
/// that leg begins.
std::size_t rests_before_legs(const std::vector<Interval>& rests, std::span<const TimedServo> servo,
                              HostTime origin) {
  const auto leg = std::find_if(servo.begin(), servo.end(),
                                [](const TimedServo& message) { return message.state.leg != 0; });
  if (leg == servo.end()) return rests.size();
  const double leg_s = to_s(leg->stamp.time - origin);
  return static_cast<std::size_t>(std::count_if(
      rests.begin(), rests.end(), [leg_s](const Interval& rest) { return rest.begin_s < leg_s; }));
}

/// Bias and its uncertainty from quiet blocks: what they scatter, and what the bias drifted by. `opening`:
/// how many of the `rests` come before the first leg.
void note_rests(GyroErrors& errors, const std::vector<Block>& blocks, std::size_t opening,
                std::size_t rests) {
  const std::vector<double> means = each(blocks, mean_of);
  const double bias_dps = median(means);
  const double scatter_dps = robust_deviation(means, bias_dps);
  const double seen = std::sqrt(static_cast<double>(means.size()));
  errors.noise_dps = median(each(blocks, deviation_of));
  errors.bias_before_dps = bias_of_rests(blocks, 0, opening);
  if (rests > opening) errors.bias_after_dps = bias_of_rests(blocks, rests - 1, rests);
  const bool both = errors.bias_before_dps && errors.bias_after_dps;
  const double drift_dps = both ? *errors.bias_after_dps - *errors.bias_before_dps : 0.0;
  errors.bias_dps = Estimate{bias_dps, std::hypot(std::hypot(scatter_dps / seen, least_uncertainty_dps),
                                                  both ? drift_dps / std::sqrt(12.0) : unseen_drift_dps)};
}

/// Bias from steady legs: what the gyro shows beside a share of the commanded speed. The share is known as
/// well as gyro and servo are, so one direction alone says little, and both say much.
std::optional<Estimate> bias_from_legs(std::span<const TimedGyro> gyro, std::span<const TimedServo> servo,
                                       HostTime origin, const GyroErrors& assumed) {
  LeastSquares equations(2);
  const double share_doubt = std::hypot(assumed.scale.uncertainty, servo_scale_doubt);
  equations.add_prior(0, assumed.scale.value, share_doubt);
  equations.add_prior(1, 0.0, unknown_bias_dps);
  bool any = false;
  for (const Interval& leg : steady_intervals(servo, origin, false)) {
    GyroBlock block;
    for (const TimedGyro& sample :
         between(gyro, origin + from_s(leg.begin_s + settled_after_s), origin + from_s(leg.end_s)))
      if (is_measured(sample)) block.add(sample);
    if (block.shaft_dps.count() < least_samples) continue;
    const std::array<double, 2> row{leg.rate_dps, 1.0};
    equations.add(row, block.mean_dps(), std::hypot(leg_deviation_dps, leg_deviation * leg.rate_dps));
    any = true;
  }
  if (!any) return std::nullopt;
  return Estimate{equations.solve()[1], std::sqrt(equations.variance(std::array{0.0, 1.0}))};
}
}  // namespace

GyroErrors fit_gyro_errors(std::span<const TimedGyro> gyro, std::span<const TimedServo> servo,
                           const GyroProfile& profile) {
  GyroErrors errors = labels::assumed_gyro_errors(profile);
  if (gyro.empty() || servo.empty()) return errors;
  const HostTime origin = servo.front().stamp.time;
  const std::vector<Interval> rests = steady_intervals(servo, origin, true);
  errors.zeroes_itself = zeroes_itself(gyro, rests, origin);
  std::vector<Block> blocks = blocks_of(gyro, rests, origin);
  keep_quiet(blocks);
  if (!blocks.empty()) note_rests(errors, blocks, rests_before_legs(rests, servo, origin), rests.size());
  if (!blocks.empty() && !errors.zeroes_itself) return errors;
  if (errors.zeroes_itself) errors.bias_dps = labels::assumed_gyro_errors(profile).bias_dps;
  const auto by_legs = bias_from_legs(gyro, servo, origin, errors);
  if (by_legs &&
      (!errors.bias_dps || errors.zeroes_itself || by_legs->uncertainty < errors.bias_dps->uncertainty)) {
    errors.bias_dps = by_legs;
    errors.bias_from_legs = true;
  }
  return errors;
}

GyroErrors fit_gyro_errors_without_servo(std::span<const TimedGyro> gyro, std::span<const TimedFrame> frames,
                                         const GyroProfile& profile) {
  GyroErrors errors = labels::assumed_gyro_errors(profile);
  errors.bias_dps.reset();
  const std::vector<Interval> rests = rests_by_gyro(gyro);
  if (rests.empty()) return errors;
  const HostTime origin = gyro.front().stamp.time;
  const auto at = [&](double time_s) { return origin + from_s(time_s); };
  if (!are_images_still(frames, at(rests.front().begin_s), at(rests.front().end_s))) return errors;
  errors.zeroes_itself = zeroes_itself(gyro, rests, origin);
  std::vector<Block> blocks = blocks_of(gyro, rests, origin);
  keep_quiet(blocks);
  if (blocks.empty() || errors.zeroes_itself) return errors;
  note_rests(errors, blocks, 1, rests.size());
  for (std::size_t rest = 0; rest < rests.size() && rests.size() > 1; ++rest)
    if (const auto bias_dps = bias_of_rests(blocks, rest, rest + 1))
      errors.bias_course.push_back({at((rests[rest].begin_s + rests[rest].end_s) / 2.0), *bias_dps});
  return errors;
}

namespace {
constexpr double shortest_part_s = 1.0;         // of a leg's part that is looked at
constexpr double slowest_looked_at_dps = 10.0;  // below it a servo's own unsteadiness matters more
constexpr double least_decay = 0.03;            // a second: a servo keeps a slow speed better than that
constexpr double sure_deviations = 4.0;
constexpr std::size_t fewest_a_direction = 2;

struct LegDecay {
  double rate_dps, decay_per_s;
};

/// From the first to the second half of what is steady in each leg, as a share of the command.
std::vector<LegDecay> decays_of(std::span<const TimedServo> servo, const GyroIntegral& gyro,
                                HostTime origin) {
  std::vector<LegDecay> legs;
  for (const Interval& leg : steady_intervals(servo, origin, false)) {
    const double begin_s = leg.begin_s + settled_after_s, half_s = (leg.end_s - begin_s) / 2.0;
    if (2.0 * half_s < shortest_part_s || std::abs(leg.rate_dps) < slowest_looked_at_dps) continue;
    const double fall_dps =
        gyro.mean_dps(begin_s, begin_s + half_s) - gyro.mean_dps(begin_s + half_s, leg.end_s);
    if (std::isfinite(fall_dps)) legs.push_back({leg.rate_dps, fall_dps / leg.rate_dps / half_s});
  }
  return legs;
}
}  // namespace

double gyro_decay_per_s(std::span<const TimedGyro> gyro, std::span<const TimedServo> servo,
                        const GyroErrors& errors) {
  if (gyro.empty() || servo.empty()) return 0.0;
  const HostTime origin = servo.front().stamp.time;
  const std::vector<LegDecay> legs = decays_of(servo, GyroIntegral(gyro, errors, origin), origin);
  std::vector<double> speeds_dps;
  for (const LegDecay& leg : legs) speeds_dps.push_back(std::abs(leg.rate_dps));
  const double usual_dps = median(std::move(speeds_dps));
  RunningStatistics forward, backward;
  for (const LegDecay& leg : legs)
    if (std::abs(leg.rate_dps) <= usual_dps) (leg.rate_dps > 0.0 ? forward : backward).add(leg.decay_per_s);
  const auto error = [](const RunningStatistics& of) {
    return std::sqrt(of.sample_variance() / static_cast<double>(of.count()));
  };
  if (std::min(forward.count(), backward.count()) < fewest_a_direction) return 0.0;
  const double decay = (forward.mean() + backward.mean()) / 2.0;
  const double sigma = std::hypot(error(forward), error(backward)) / 2.0;
  return decay > std::max(least_decay, sure_deviations * sigma) ? decay : 0.0;
}

}  // namespace thermorig::fit
