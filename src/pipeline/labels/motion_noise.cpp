// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/labels/motion_noise.h"

#include <algorithm>
#include <cmath>

namespace thermorig::labels {

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
