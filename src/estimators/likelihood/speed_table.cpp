// SPDX-License-Identifier: MIT
#include "speed_table.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <numbers>
#include <numeric>

#include "window_covariance.h"

namespace thermorig::likelihood {

namespace {

constexpr double least_step = 0.05, step_growth = 0.02;
constexpr double least_variance = 2e-3;  // of a pattern: noise hides what is less

/// Eigenvalues and their vectors.
struct Spectrum {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;

  /// The largest first.
  void sort() {
    std::vector<Eigen::Index> order(static_cast<std::size_t>(values.size()));
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [this](Eigen::Index a, Eigen::Index b) { return values[a] > values[b]; });
    values = values(order).eval();
    vectors = vectors(Eigen::all, order).eval();
  }
};

Spectrum spectrum_of(const Eigen::MatrixXd& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

/// Of one that stays as it is when rows and columns are reversed. Its vectors are the same from both ends,
/// but perhaps for the sign: two problems of half the size, which take a quarter of the time.
Spectrum spectrum_from_both_ends(const Eigen::MatrixXd& covariance) {
  const Eigen::Index half = covariance.rows() / 2;
  const Eigen::MatrixXd near = covariance.topLeftCorner(half, half);
  const Eigen::MatrixXd far = covariance.topRightCorner(half, half).rowwise().reverse();
  const Spectrum even = spectrum_of(near + far), odd = spectrum_of(near - far);
  Spectrum all{Eigen::VectorXd(2 * half), Eigen::MatrixXd(2 * half, 2 * half)};
  all.values << even.values, odd.values;
  all.vectors << even.vectors, odd.vectors,  //
      even.vectors.colwise().reverse(), -odd.vectors.colwise().reverse();
  all.vectors *= std::numbers::sqrt2 / 2.0;
  return all;
}

/// Of both classes of rows. Each of them is the same from both ends, so that the second half of both is put
/// in order after the first half of both.
Spectrum spectrum_of_classes(const Eigen::MatrixXd& covariance) {
  const Eigen::Index half = covariance.rows() / 4;
  Eigen::VectorXi order(4 * half);
  for (Eigen::Index i = 0; i < half; ++i) {
    const int first = static_cast<int>(i), second = static_cast<int>(2 * half + i);
    order[i] = first;
    order[half + i] = second;
    order[4 * half - 1 - i] = static_cast<int>(2 * half - 1 - i);
    order[3 * half - 1 - i] = static_cast<int>(4 * half - 1 - i);
  }
  Spectrum spectrum = spectrum_from_both_ends(covariance(order, order));
  const Eigen::MatrixXd ordered = spectrum.vectors;
  spectrum.vectors(order, Eigen::all) = ordered;
  return spectrum;
}

SpeedPatterns patterns_of(const Eigen::MatrixXd& covariance, Spectrum spectrum, double speed) {
  spectrum.sort();
  const auto lines = static_cast<std::size_t>(covariance.rows());
  SpeedPatterns patterns{.speed = speed, .trace = covariance.trace()};
  patterns.count = static_cast<std::size_t>((spectrum.values.array() >= least_variance).count());
  const std::size_t groups = (patterns.count + patterns_a_group - 1) / patterns_a_group;
  patterns.variance.resize(groups * patterns_a_group);
  patterns.pattern.resize(groups * patterns_a_group * lines);
  for (std::size_t k = 0; k < patterns.count; ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    patterns.variance[k] = static_cast<float>(spectrum.values[at]);
    float* group = &patterns.pattern[(k / patterns_a_group) * lines * patterns_a_group];
    for (std::size_t i = 0; i < lines; ++i)
      group[i * patterns_a_group + k % patterns_a_group] =
          static_cast<float>(spectrum.vectors(static_cast<Eigen::Index>(i), at));
  }
  return patterns;
}

/// The mean over all but the longest.
double likeness_of_shared_waves() {
  double sum = 0.0;
  for (std::size_t wave = 1; wave < shared_waves; ++wave) sum += likeness_of_classes(wave);
  return sum / static_cast<double>(shared_waves - 1);
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

}  // namespace

SpeedTable::SpeedTable(std::size_t halves) {
  // Of an even number of halves the first and the last one look at columns of the other kind.
  const bool is_even = halves % 2 == 0;
  const double likeness = likeness_of_shared_waves();
  for (const double speed : symmetric_speeds()) {
    const Eigen::MatrixXd own = window_covariance(halves, speed);
    own_.push_back(patterns_of(own, is_even ? spectrum_from_both_ends(own) : spectrum_of(own), speed));
    if (speed < 0.0) continue;
    const auto of_classes = is_even ? spectrum_of_classes : spectrum_of;
    const Eigen::MatrixXd shared = covariance_of_classes(halves, speed, likeness);
    shared_.push_back(patterns_of(shared, of_classes(shared), speed));
    Eigen::MatrixXd longest = covariance_of_classes(halves, speed, likeness_of_classes(0));
    centre_halves(longest);
    longest_.push_back(patterns_of(longest, of_classes(longest), speed));
  }
}

std::size_t SpeedTable::speeds() {
  return symmetric_speeds().size();
}

const SpeedTable& SpeedTable::of(std::size_t halves) {
  static_assert(least_halves == 2 && most_halves == 4);
  if (halves == 2) {
    static const SpeedTable two(2);
    return two;
  }
  if (halves == 3) {
    static const SpeedTable three(3);
    return three;
  }
  static const SpeedTable four(4);
  return four;
}

}  // namespace thermorig::likelihood
