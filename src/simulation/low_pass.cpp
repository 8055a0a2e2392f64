// SPDX-License-Identifier: MIT
#include "low_pass.h"

#include <cmath>
#include <numbers>

namespace thermorig::simulation {

LowPass::LowPass(double bandwidth_hz, double step_s) {
  const double corner = std::tan(std::numbers::pi * bandwidth_hz * step_s);
  const double square = corner * corner;
  const double norm = 1.0 + std::numbers::sqrt2 * corner + square;
  gain_ = square / norm;
  feedback_1_ = 2.0 * (square - 1.0) / norm;
  feedback_2_ = (1.0 - std::numbers::sqrt2 * corner + square) / norm;
  delay_s_ = step_s / (std::numbers::sqrt2 * corner);
}

void LowPass::settle(double value) {
  in_1_ = in_2_ = out_1_ = out_2_ = value;
}

double LowPass::next(double value) {
  const double out = gain_ * (value + 2.0 * in_1_ + in_2_) - feedback_1_ * out_1_ - feedback_2_ * out_2_;
  in_2_ = in_1_;
  in_1_ = value;
  out_2_ = out_1_;
  out_1_ = out;
  return out;
}

}  // namespace thermorig::simulation
