// SPDX-License-Identifier: MIT
#include "rest.h"

#include <algorithm>
#include <cmath>

#include "thermorig/core/gyro_blocks.h"

namespace thermorig::calibration {

namespace {

constexpr auto block_length = std::chrono::seconds(2);
constexpr std::size_t fewest_blocks = 3;
constexpr std::size_t fewest_samples = 20;  // of a block, and no less than half of what the fullest has

/// Blocks of 2 s in the rests.
std::vector<GyroBlock> blocks_of(std::span<const TimedServo> servo, std::span<const TimedGyro> gyro) {
  const auto counts = [](const TimedGyro& sample) { return !sample.reading.saturated; };
  std::vector<GyroBlock> blocks;
  std::size_t fullest = 0;
  for (const Rest& rest : rests_of(servo, gyro))
    for (const GyroBlock& block :
         gyro_blocks(gyro, rest.begin, rest.end, {block_length, fewest_samples, counts}))
      blocks.push_back(block);
  for (const GyroBlock& block : blocks) fullest = std::max(fullest, block.shaft_dps.count());
  std::erase_if(blocks, [&](const GyroBlock& block) { return 2 * block.shaft_dps.count() < fullest; });
  return blocks;
}

template <typename Value>
double quantile_of(const std::vector<GyroBlock>& blocks, double share, Value value) {
  std::vector<double> values;
  for (const GyroBlock& block : blocks) values.push_back(value(block));
  return lower_quantile(values, share);
}

/// Somebody touched the rig: a block is noisier than the quiet ones, or its mean lies far from theirs. Hands
/// may be on the rig for more than half of the time, so what is quiet is told by the quietest quarter.
void leave_out_disturbed(std::vector<GyroBlock>& blocks) {
  const double noise_dps =
      quantile_of(blocks, 0.25, [](const GyroBlock& block) { return block.deviation_dps(); });
  std::erase_if(blocks,
                [&](const GyroBlock& block) { return block.deviation_dps() > 2.0 * noise_dps + 1e-6; });
  if (blocks.empty()) return;
  const double middle_dps = quantile_of(blocks, 0.5, [](const GyroBlock& block) { return block.mean_dps(); });
  const double usual_dps = quantile_of(
      blocks, 0.5, [&](const GyroBlock& block) { return std::abs(block.mean_dps() - middle_dps); });
  const double limit_dps = std::max(10.0 * usual_dps, noise_dps);
  std::erase_if(blocks,
                [&](const GyroBlock& block) { return std::abs(block.mean_dps() - middle_dps) > limit_dps; });
}

double mean_of(std::span<const GyroBlock> blocks) {
  double sum = 0.0;
  for (const GyroBlock& block : blocks) sum += block.mean_dps();
  return sum / static_cast<double>(blocks.size());
}

}  // namespace

std::vector<Rest> rests_of(std::span<const TimedServo> servo, std::span<const TimedGyro> gyro) {
  if (!servo.empty() || gyro.empty()) return session::servo_rests(servo);
  const Rest all{gyro.front().stamp.time, gyro.back().stamp.time};
  return all.end > all.begin ? std::vector<Rest>{all} : std::vector<Rest>{};
}

std::optional<RestingGyro> resting_gyro(std::span<const TimedServo> servo, std::span<const TimedGyro> gyro) {
  std::vector<GyroBlock> blocks = blocks_of(servo, gyro);
  if (!blocks.empty()) leave_out_disturbed(blocks);
  if (blocks.size() < fewest_blocks) return std::nullopt;
  RestingGyro result{.parts = blocks.size()};
  result.bias_dps = mean_of(blocks);
  double squares = 0.0;
  for (const GyroBlock& block : blocks) {
    const double off_dps = block.mean_dps() - result.bias_dps;
    squares += off_dps * off_dps;
    result.noise_dps += block.deviation_dps() / static_cast<double>(blocks.size());
  }
  result.spread_dps = std::sqrt(squares / static_cast<double>(blocks.size() - 1));
  const std::size_t third = blocks.size() / 3;
  result.drift_dps = mean_of(std::span(blocks).last(third)) - mean_of(std::span(blocks).first(third));
  result.rest_s = static_cast<double>(blocks.size()) * to_s(block_length);
  return result;
}

}  // namespace thermorig::calibration
