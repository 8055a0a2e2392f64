// SPDX-License-Identifier: MIT
#include "contest.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace thermorig::motion {
namespace {

constexpr std::size_t fewest_blocks = 4;
constexpr double least_spread = 1e-9;
constexpr double least_misfit = 1e-6;  // K2, less than rounding on the wire

/// Student's: mean by its own standard deviation.
double lead_of_mean(std::span<const double> differences) {
  const auto count = static_cast<double>(differences.size());
  double mean = 0.0;
  for (const double difference : differences) mean += difference / count;
  double square = least_spread;
  for (const double difference : differences) square += (difference - mean) * (difference - mean);
  return mean / std::sqrt(square / (count - 1.0) / count);
}

/// Wilcoxon's, of signed ranks: were the signs chance, it would be a standard normal variable.
double lead_of_ranks(std::vector<double> differences) {
  std::sort(differences.begin(), differences.end(),
            [](double left, double right) { return std::abs(left) < std::abs(right); });
  double sum = 0.0, square = 0.0, rank = 0.0;
  for (const double difference : differences) {
    rank += 1.0;
    square += rank * rank;
    if (difference != 0.0) sum += std::copysign(rank, difference);
  }
  return sum / std::sqrt(square);
}

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
  const double of_mean = lead_of_mean(differences_), of_ranks = lead_of_ranks(differences_);
  return std::abs(of_mean) > std::abs(of_ranks) ? of_mean : of_ranks;
}

}  // namespace thermorig::motion
