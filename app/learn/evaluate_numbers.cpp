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

}  // namespace thermorig::app
