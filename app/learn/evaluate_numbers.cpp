// SPDX-License-Identifier: MIT
#include "evaluate_numbers.h"

#include <fmt/format.h>

#include <cmath>

namespace thermorig::app {

namespace {

std::string text(double value, int digits) {
  return std::isnan(value) ? "unknown" : fmt::format("{:.{}f}", value, digits);
}

}  // namespace

std::string mse_text(double mse) {
  return text(mse, 5);
}
std::string rate_text(double rate_dps) {
  return text(rate_dps, 2);
}
std::string gain_text(double gain) {
  return text(gain, 3);
}
std::string percent_text(double share) {
  return std::isnan(share) ? "unknown" : text(100.0 * share, 1) + " %";
}
std::string angle_text(double deg) {
  return text(deg, 1);
}

std::string collapsed_text(double gain_mean) {
  return fmt::format("the gate has collapsed (mean Kg {}): {}", gain_text(gain_mean),
                     gain_mean < 0.5 ? "the gyro alone decides, the images are not used"
                                     : "the images alone decide, the gyro is not used");
}

}  // namespace thermorig::app
