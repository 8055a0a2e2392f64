// SPDX-License-Identifier: MIT
#include "error_statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "estimates.h"
#include "thermorig/core/estimate.h"
#include "thermorig/core/statistics.h"

namespace thermorig::study {

namespace {

/// Squared errors of the windows at one speed.
struct SpeedSums {
  std::uint64_t windows = 0;
  std::array<std::uint64_t, estimator_count> counts{};
  std::array<double, estimator_count> squares{};
};

void add(SpeedSums& sums, Estimator estimator, double error_dps) {
  if (!std::isfinite(error_dps)) return;
  ++sums.counts[index_of(estimator)];
  sums.squares[index_of(estimator)] += error_dps * error_dps;
}

SpeedErrors speed_errors_of(double rate_dps, const SpeedSums& sums, double scale_dps) {
  SpeedErrors errors{rate_dps, sums.windows, {}};
  for (std::size_t i = 0; i < estimator_count; ++i) {
    const double mean = sums.squares[i] / static_cast<double>(sums.counts[i]);
    errors.mse[i] = sums.counts[i] > 0 ? mean / (scale_dps * scale_dps) : unknown;
  }
  return errors;
}

/// Legs of one speed have the same value; what a file adds to it in rounding must not part them.
double speed_key(float rate_dps) {
  return std::round(double{rate_dps} * 1000.0) / 1000.0 + 0.0;  // no -0
}

}  // namespace

void ErrorStatistics::add(double error_dps) {
  if (!std::isfinite(error_dps)) return;
  sum_ += error_dps;
  squares_ += error_dps * error_dps;
  const double magnitude = std::abs(error_dps);
  outliers_ += magnitude > outlier_dps ? 1 : 0;
  magnitudes_.push_back(magnitude);
}

Errors ErrorStatistics::errors() {
  if (magnitudes_.empty()) return {0, unknown, unknown, unknown, unknown, unknown, unknown};
  std::sort(magnitudes_.begin(), magnitudes_.end());
  const double count = static_cast<double>(magnitudes_.size());
  const double mean_square = squares_ / count;
  Errors errors;
  errors.windows = magnitudes_.size();
  errors.mse = mean_square / (scale_dps_ * scale_dps_);
  errors.rmse_dps = std::sqrt(mean_square);
  errors.median_dps = quantile(magnitudes_, 0.5);
  errors.p95_dps = quantile(magnitudes_, 0.95);
  errors.outlier_share = static_cast<double>(outliers_) / count;
  errors.bias_dps = sum_ / count;
  return errors;
}

std::vector<SpeedErrors> speed_errors(std::span<const training::WindowEstimate> estimates,
                                      std::span<const windows::Acquisition> acquisitions,
                                      const EvaluationConfig& config) {
  std::map<double, SpeedSums> by_speed;
  for (const training::WindowEstimate& estimate : estimates) {
    const float rate_dps = acquisitions[estimate.window.acquisition].leg_rate_dps[estimate.window.last];
    if (!std::isfinite(estimate.label_dps) || !std::isfinite(rate_dps)) continue;
    SpeedSums& sums = by_speed[speed_key(rate_dps)];
    ++sums.windows;
    for (const Estimator estimator : all_estimators)
      add(sums, estimator,
          speed_of(estimate, estimator, acquisitions, config.fusion) - double{estimate.label_dps});
  }
  std::vector<SpeedErrors> speeds;
  for (const auto& [rate_dps, sums] : by_speed)
    speeds.push_back(speed_errors_of(rate_dps, sums, config.label_scale_dps));
  return speeds;
}

}  // namespace thermorig::study
