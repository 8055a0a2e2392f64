// SPDX-License-Identifier: MIT
#include "error_statistics.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "thermorig/core/statistics.h"

namespace thermorig::study {

namespace {

/// Of the windows at one speed.
struct SpeedSums {
  std::uint64_t windows = 0;
  PerEstimator<estimators::RateErrors> errors;

  void add(const JudgedWindow& judged) {
    ++windows;
    for (const std::string& name : all_estimators()) {
      const double error_dps = double{judged.rate_dps[name]} - double{judged.label_dps};
      if (std::isfinite(error_dps)) errors[name].add(error_dps);
    }
  }

  SpeedErrors at(double rate_dps, double label_scale_dps) const {
    SpeedErrors speed{rate_dps, windows};
    for (const std::string& name : all_estimators()) speed.mse[name] = errors[name].mse(label_scale_dps);
    return speed;
  }
};

/// Legs of one speed have the same value; what a file adds to it in rounding must not part them.
double speed_key(float rate_dps) {
  return std::round(double{rate_dps} * 1000.0) / 1000.0 + 0.0;  // no -0
}

}  // namespace

void ErrorStatistics::add(double error_dps) {
  if (!std::isfinite(error_dps)) return;
  sums_.add(error_dps);
  const double magnitude = std::abs(error_dps);
  outliers_ += magnitude > outlier_dps ? 1 : 0;
  magnitudes_.push_back(magnitude);
}

Errors ErrorStatistics::errors(double label_scale_dps) {
  if (magnitudes_.empty()) return {};
  std::sort(magnitudes_.begin(), magnitudes_.end());
  return {.windows = sums_.count(),
          .mse = sums_.mse(label_scale_dps),
          .rmse_dps = sums_.rmse_dps(),
          .median_dps = quantile(magnitudes_, 0.5),
          .p95_dps = quantile(magnitudes_, 0.95),
          .outlier_share = static_cast<double>(outliers_) / static_cast<double>(sums_.count()),
          .bias_dps = sums_.mean_dps()};
}

std::vector<SpeedErrors> speed_errors(std::span<const JudgedWindow> judged,
                                      std::span<const network::Acquisition> acquisitions,
                                      double label_scale_dps) {
  std::map<double, SpeedSums> by_speed;
  for (const JudgedWindow& one : judged) {
    const float rate_dps = acquisitions[one.window.acquisition].leg_rate_dps[one.window.last];
    if (std::isfinite(one.label_dps) && std::isfinite(rate_dps)) by_speed[speed_key(rate_dps)].add(one);
  }
  std::vector<SpeedErrors> speeds;
  for (const auto& [rate_dps, sums] : by_speed) speeds.push_back(sums.at(rate_dps, label_scale_dps));
  return speeds;
}

}  // namespace thermorig::study
