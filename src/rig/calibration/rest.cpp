// SPDX-License-Identifier: MIT
#include "rest.h"

#include <algorithm>
#include <cmath>

#include "thermorig/core/statistics.h"

namespace thermorig::calibration {

namespace {

constexpr auto part_length = std::chrono::seconds(2);
constexpr std::size_t fewest_parts = 3;
constexpr std::size_t fewest_samples = 20;  // of a part, and no less than half of what the fullest has

struct Part {
  double mean_dps = 0.0;
  double noise_dps = 0.0;
  std::size_t samples = 0;
};

/// Mean and standard deviation of the samples in `rest`; `next` moves on behind them.
Part part_of(std::span<const TimedGyro> gyro, const Rest& rest, std::size_t& next) {
  while (next < gyro.size() && gyro[next].stamp.time < rest.begin) ++next;
  double sum = 0.0, squares = 0.0;
  Part part;
  for (; next < gyro.size() && gyro[next].stamp.time < rest.end; ++next) {
    const double rate_dps = gyro[next].rate_dps;
    if (!std::isfinite(rate_dps) || gyro[next].reading.saturated) continue;
    sum += rate_dps;
    squares += rate_dps * rate_dps;
    ++part.samples;
  }
  if (part.samples == 0) return part;
  const auto count = static_cast<double>(part.samples);
  part.mean_dps = sum / count;
  part.noise_dps = std::sqrt(std::max(0.0, squares / count - part.mean_dps * part.mean_dps));
  return part;
}

std::vector<Part> parts_of(std::span<const TimedServo> servo, std::span<const TimedGyro> gyro) {
  std::vector<Part> parts;
  std::size_t next = 0, fullest = 0;
  for (const Rest& rest : rests_of(servo, gyro))
    for (HostTime begin = rest.begin; begin + part_length <= rest.end && next < gyro.size();) {
      parts.push_back(part_of(gyro, {begin, begin + part_length}, next));
      begin += part_length;
      // Where no samples came there is nothing to part, however long that was.
      if (next < gyro.size() && gyro[next].stamp.time > begin + part_length) begin = gyro[next].stamp.time;
    }
  for (const Part& part : parts) fullest = std::max(fullest, part.samples);
  std::erase_if(
      parts, [&](const Part& part) { return part.samples < fewest_samples || 2 * part.samples < fullest; });
  return parts;
}

template <typename Value>
double quantile_of(const std::vector<Part>& parts, double share, Value value) {
  std::vector<double> values;
  for (const Part& part : parts) values.push_back(value(part));
  return lower_quantile(values, share);
}

/// Somebody touched the rig: a part is noisier than the quiet ones, or its mean lies far from theirs. Hands
/// may be on the rig for more than half of the time, so what is quiet is told by the quietest quarter.
void leave_out_disturbed(std::vector<Part>& parts) {
  const double noise_dps = quantile_of(parts, 0.25, [](const Part& part) { return part.noise_dps; });
  std::erase_if(parts, [&](const Part& part) { return part.noise_dps > 2.0 * noise_dps + 1e-6; });
  if (parts.empty()) return;
  const double middle_dps = quantile_of(parts, 0.5, [](const Part& part) { return part.mean_dps; });
  const double usual_dps =
      quantile_of(parts, 0.5, [&](const Part& part) { return std::abs(part.mean_dps - middle_dps); });
  const double limit_dps = std::max(10.0 * usual_dps, noise_dps);
  std::erase_if(parts, [&](const Part& part) { return std::abs(part.mean_dps - middle_dps) > limit_dps; });
}

double mean_of(std::span<const Part> parts) {
  double sum = 0.0;
  for (const Part& part : parts) sum += part.mean_dps;
  return sum / static_cast<double>(parts.size());
}

}  // namespace

std::vector<Rest> rests_of(std::span<const TimedServo> servo, std::span<const TimedGyro> gyro) {
  if (!servo.empty() || gyro.empty()) return session::servo_rests(servo);
  const Rest all{gyro.front().stamp.time, gyro.back().stamp.time};
  return all.end > all.begin ? std::vector<Rest>{all} : std::vector<Rest>{};
}

std::optional<RestingGyro> resting_gyro(std::span<const TimedServo> servo, std::span<const TimedGyro> gyro) {
  std::vector<Part> parts = parts_of(servo, gyro);
  if (!parts.empty()) leave_out_disturbed(parts);
  if (parts.size() < fewest_parts) return std::nullopt;
  RestingGyro result{.parts = parts.size()};
  result.bias_dps = mean_of(parts);
  double squares = 0.0;
  for (const Part& part : parts) {
    const double off_dps = part.mean_dps - result.bias_dps;
    squares += off_dps * off_dps;
    result.noise_dps += part.noise_dps / static_cast<double>(parts.size());
  }
  result.spread_dps = std::sqrt(squares / static_cast<double>(parts.size() - 1));
  const std::size_t third = parts.size() / 3;
  result.drift_dps = mean_of(std::span(parts).last(third)) - mean_of(std::span(parts).first(third));
  result.rest_s = static_cast<double>(parts.size()) * to_s(part_length);
  return result;
}

}  // namespace thermorig::calibration
