// SPDX-License-Identifier: MIT
#include "speed_table.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "window_covariance.h"

namespace thermorig::likelihood {

namespace {

constexpr double least_step = 0.05, step_growth = 0.02;
constexpr double least_variance = 2e-3;  // of a pattern: noise hides what is less

SpeedPatterns patterns_at(std::size_t halves, double speed, bool is_centred) {
  Eigen::MatrixXd covariance = window_covariance(halves, speed);
  if (is_centred) centre_halves(covariance, halves);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
  const Eigen::VectorXd variances = solver.eigenvalues().reverse();
  const auto lines = static_cast<std::size_t>(covariance.rows());
  SpeedPatterns patterns{.speed = speed, .trace = covariance.trace()};
  patterns.count = static_cast<std::size_t>((variances.array() >= least_variance).count());
  const std::size_t groups = (patterns.count + patterns_a_group - 1) / patterns_a_group;
  patterns.variance.resize(groups * patterns_a_group);
  patterns.pattern.resize(groups * patterns_a_group * lines);
  for (std::size_t k = 0; k < patterns.count; ++k) {
    const auto from_least = static_cast<Eigen::Index>(lines - 1 - k);
    patterns.variance[k] = static_cast<float>(solver.eigenvalues()[from_least]);
    float* group = &patterns.pattern[(k / patterns_a_group) * lines * patterns_a_group];
    for (std::size_t i = 0; i < lines; ++i)
      group[i * patterns_a_group + k % patterns_a_group] =
          static_cast<float>(solver.eigenvectors()(static_cast<Eigen::Index>(i), from_least));
  }
  return patterns;
}

std::vector<double> symmetric_speeds() {
  std::vector<double> speeds{0.0};
  for (double speed = least_step; speed <= largest_speed; speed += least_step + step_growth * speed) {
    speeds.push_back(speed);
    speeds.push_back(-speed);
  }
  std::sort(speeds.begin(), speeds.end());
  return speeds;
}

template <bool is_centred>
const SpeedTable& table_of(std::size_t halves) {
  static_assert(least_halves == 2 && most_halves == 4);
  if (halves == 2) {
    static const SpeedTable two(2, is_centred);
    return two;
  }
  if (halves == 3) {
    static const SpeedTable three(3, is_centred);
    return three;
  }
  static const SpeedTable four(4, is_centred);
  return four;
}

}  // namespace

SpeedTable::SpeedTable(std::size_t halves, bool is_centred) {
  for (const double speed : symmetric_speeds()) speeds_.push_back(patterns_at(halves, speed, is_centred));
}

const SpeedTable& SpeedTable::of(std::size_t halves, bool is_centred) {
  return is_centred ? table_of<true>(halves) : table_of<false>(halves);
}

}  // namespace thermorig::likelihood
