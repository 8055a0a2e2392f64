// SPDX-License-Identifier: MIT
#include "label_terms.h"

#include <algorithm>
#include <cmath>

namespace thermorig::labels {

namespace {
constexpr double assumed_slope_error = 0.005;  // along the travel, of hobby servos
constexpr double assumed_ripple_dps = 0.3;     // of an exposure's mean, where the loop is only guessed
constexpr double least_gyro_error_dps = 0.05;  // resolution and cross axes
constexpr double least_model_error_dps =
    0.06;  // what is the same in all frames of a speed, and hides in its mean
constexpr double chance_deviations = 3.0;

/// Straight between the speeds of the table, constant beyond them. It is not empty.
template <typename Column>
double tabled(const ServoResponse& response, double rate_dps, const Column& column) {
  const auto& speeds = response.speeds;
  const auto slower = [](const ServoResponse::AtSpeed& at, double rate) { return at.rate_dps < rate; };
  const auto next = std::lower_bound(speeds.begin(), speeds.end(), rate_dps, slower);
  if (next == speeds.begin()) return column(speeds.front());
  if (next == speeds.end()) return column(speeds.back());
  const auto before = next - 1;
  const double share = (rate_dps - before->rate_dps) / (next->rate_dps - before->rate_dps);
  return std::lerp(column(*before), column(*next), share);
}

/// What the fit left at that speed; nullptr: it knows none.
const ServoResponse::AtSpeed* known_at(const ServoResponse& response, double commanded_dps) {
  const ServoResponse::AtSpeed* const seen = response.fitted ? seen_at(response, commanded_dps) : nullptr;
  return seen != nullptr && std::isfinite(seen->residual_dps) ? seen : nullptr;
}

/// How much faster the shaft was than the model has it, on the scale of the response.
double beyond_model_dps(const ServoResponse& response, const ServoResponse::AtSpeed& seen) {
  return response.scale.value / response.gyro_ratio.value * seen.residual_dps;
}

/// Noise that explains nothing where none is known: a spread then counts as motion.
double known_noise_dps(const GyroErrors& errors) {
  return std::isfinite(errors.noise_dps) ? errors.noise_dps : 0.0;
}
}  // namespace

double model_deviation_dps(const ServoResponse& response, double rate_dps) {
  const bool measured = !response.speeds.empty() || std::isfinite(response.residual_dps);
  if (!response.fitted || !measured) return std::hypot(assumed_ripple_dps, assumed_slope_error * rate_dps);
  if (response.speeds.empty()) return response.residual_dps;
  const double tabled_dps = tabled(response, rate_dps, [](const ServoResponse::AtSpeed& at) {
    return std::hypot(at.residual_dps, at.spread_dps, least_model_error_dps);
  });
  return std::isfinite(tabled_dps) ? tabled_dps : response.residual_dps;
}

double gyro_noise_dps(const GyroErrors& errors, const ServoResponse& response, double rate_dps,
                      double so_far_dps) {
  const double at_rest_dps = known_noise_dps(errors);
  if (!response.fitted || response.speeds.empty()) return std::max(at_rest_dps, so_far_dps);
  const double turning_dps =
      tabled(response, rate_dps, [](const ServoResponse::AtSpeed& at) { return at.noise_dps; });
  return std::fmax(at_rest_dps, turning_dps);
}

double corrected_dps(const ServoResponse& response, double commanded_dps, double gain) {
  if (!response.fitted) return commanded_dps;
  const ServoResponse::AtSpeed* const seen = known_at(response, commanded_dps);
  return gain * commanded_dps + (seen == nullptr ? 0.0 : beyond_model_dps(response, *seen));
}

double label_deviation_dps(const ServoResponse& response, double commanded_dps, double label_dps,
                           double shaft_dps, double time_dps) {
  const double scale_dps = response.scale.uncertainty / response.scale.value * shaft_dps;
  const ServoResponse::AtSpeed* const seen = known_at(response, commanded_dps);
  const double off_dps = label_dps - shaft_dps - (seen == nullptr ? 0.0 : beyond_model_dps(response, *seen));
  const double left_dps = seen == nullptr ? model_deviation_dps(response, commanded_dps)
                                          : std::hypot(seen->spread_dps, least_model_error_dps);
  return std::hypot(std::hypot(off_dps, left_dps), scale_dps, time_dps);
}

double gyro_z_score(const GyroErrors& errors, const ServoResponse& response, const GyroMean& gyro,
                    double noise_dps, double bias_dps, double shaft_dps, double time_dps) {
  if (gyro.count == 0 || gyro.saturated || !errors.bias_dps || !(errors.scale.value > 0.0)) return 0.0;
  const double ratio = response.gyro_ratio.value / response.scale.value;
  const double corrected_dps = (gyro.rate_dps - bias_dps) / errors.scale.value;
  const double off_dps = corrected_dps - ratio * shaft_dps;
  const double mean_noise_dps = noise_dps / std::sqrt(static_cast<double>(gyro.count));
  const double deviation_dps =
      std::hypot(std::hypot(errors.bias_dps->uncertainty, mean_noise_dps, least_gyro_error_dps),
                 std::hypot(model_deviation_dps(response, shaft_dps), time_dps,
                            response.gyro_ratio.uncertainty * shaft_dps));
  return std::isfinite(off_dps) ? off_dps / deviation_dps : 0.0;
}

bool is_unsteady(const GyroMean& gyro, double noise_dps, double tolerance_dps) {
  if (gyro.count == 0 || gyro.saturated) return false;
  const double explained_dps2 = noise_dps * noise_dps / gyro.averaged;
  // A variance by n independent values scatters by a share of sqrt(2 / n).
  const double independent = std::max(static_cast<double>(gyro.count) / gyro.averaged, 2.0);
  const double chance_dps2 = chance_deviations * explained_dps2 * std::sqrt(2.0 / independent);
  return gyro.spread_dps * gyro.spread_dps > tolerance_dps * tolerance_dps + explained_dps2 + chance_dps2;
}

}  // namespace thermorig::labels
