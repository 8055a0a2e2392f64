// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/labels/running_bias.h"

#include <algorithm>
#include <cmath>

#include "thermorig/core/statistics.h"

namespace thermorig::labels {

namespace {
constexpr std::size_t least_rests = 4;
constexpr double least_bias_uncertainty_dps = 0.05;  // what a bias wanders off until the next rest
}  // namespace

GyroErrors assumed_gyro_errors(const GyroProfile& profile) {
  GyroErrors errors;
  errors.scale = {profile.scale, profile.scale_uncertainty};
  errors.scale_calibrated = !profile.scale_measured_utc.empty();
  errors.bias_dps = Estimate{profile.bias_dps, profile.bias_uncertainty_dps};
  return errors;
}

void RunningBias::add(const GyroMean& rest) {
  if (rest.count == 0 || (rest.rate_dps == 0.0 && rest.deviation_dps == 0.0)) return;
  means_dps_[count_ % kept] = rest.rate_dps;
  deviations_dps_[count_ % kept] = rest.deviation_dps;
  ++count_;
  if (count_ >= least_rests) renew();
}

void RunningBias::renew() {
  const auto size = static_cast<std::ptrdiff_t>(std::min(count_, kept));
  const std::vector<double> means(means_dps_.begin(), means_dps_.begin() + size);
  const double bias_dps = median(means);
  const double spread_dps = robust_deviation(means, bias_dps);
  errors_.bias_dps = Estimate{bias_dps, std::hypot(least_bias_uncertainty_dps, spread_dps)};
  errors_.noise_dps = median({deviations_dps_.begin(), deviations_dps_.begin() + size});
}

namespace {
constexpr double remembered_frames = 64.0;  // of a leg or two
}  // namespace

void MotionNoise::add(const GyroMean& moving) {
  if (moving.saturated || !std::isfinite(moving.fast_dps)) return;
  weight_ = std::min(weight_ + 1.0, remembered_frames);
  square_dps2_ += (moving.fast_dps * moving.fast_dps - square_dps2_) / weight_;
}

double MotionNoise::noise_dps() const {
  return std::sqrt(square_dps2_);
}

}  // namespace thermorig::labels
