// SPDX-License-Identifier: MIT
#include "contest.h"

#include <algorithm>
#include <cmath>

namespace thermorig::motion {
namespace {

constexpr std::size_t fewest_blocks = 4;
constexpr double least_spread = 1e-9;
constexpr double least_misfit = 1e-6;  // K2, less than rounding on the wire

}  // namespace

void Contest::add(std::span<const FreshHalf> halves, std::span<const double> first,
                  std::span<const double> second) {
  double sum = 0.0;
  double count = 0.0;
  const auto block_of = [&](std::size_t i) { return std::floor(halves[i].begin_s / block_s_); };
  for (std::size_t i = 0; i < halves.size(); ++i) {
    sum += std::log(std::max(second[i], least_misfit) / std::max(first[i], least_misfit));
    count += 1.0;
    if (i + 1 < halves.size() && block_of(i) == block_of(i + 1)) continue;
    differences_.push_back(sum / count);
    sum = count = 0.0;
  }
}

double Contest::lead() const {
  if (differences_.size() < fewest_blocks) return 0.0;
  const auto count = static_cast<double>(differences_.size());
  double mean = 0.0;
  for (const double difference : differences_) mean += difference / count;
  double square = least_spread;
  for (const double difference : differences_) square += (difference - mean) * (difference - mean);
  return mean / std::sqrt(square / (count - 1.0) / count);
}

}  // namespace thermorig::motion
