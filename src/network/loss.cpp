// SPDX-License-Identifier: MIT
#include "loss.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace thermorig::network {

namespace {

using PerSample = std::array<double, max_batch>;

double largest(std::span<const double> errors) {
  double most = 0.0;
  for (double error : errors) most = std::max(most, std::abs(error));
  return most;
}

/// What the batch is trained on: errors of y_fus and of y_th.
struct Errors {
  PerSample fusion, thermal;
};

Errors errors_of(const BatchOutputs& of) {
  Errors errors{};
  for (std::size_t i = 0; i < of.thermal.size(); ++i) {
    const double thermal = of.thermal[i], label = of.label[i];
    errors.thermal[i] = thermal - label;
    errors.fusion[i] = errors.thermal[i];
    if (of.gain.empty()) continue;
    const double gain = of.gain[i], gyro = of.gyro[i];
    errors.fusion[i] = gain * thermal + (1.0 - gain) * gyro - label;  // paper eq. 2
  }
  return errors;
}

double mean_square(std::span<const double> errors) {
  double sum = 0.0;
  for (double error : errors) sum += error * error;
  return sum / static_cast<double>(errors.size());
}

double mean_of(std::span<const float> values, double of_none) {
  if (values.empty()) return of_none;
  double sum = 0.0;
  for (float value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

}  // namespace

double berhu(std::span<const double> errors, double fraction, std::span<double> slopes) {
  const double c = fraction * largest(errors);
  const double share = 1.0 / static_cast<double>(errors.size());
  double loss = 0.0;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const double error = errors[i], size = std::abs(error);
    if (size <= c || c <= 0.0) {
      loss += size;
      slopes[i] = error == 0.0 ? 0.0 : std::copysign(share, error);
    } else {
      loss += (error * error + c * c) / (2.0 * c);
      slopes[i] = share * error / c;
    }
  }
  return loss * share;
}

namespace {

constexpr double gate_weight = 0.1;       // of the gate's own likelihood
constexpr double most_surprising = 30.0;  // square of an error in sigmas: beyond, the gate learns no more
constexpr double least_odds = 1e-9;       // of Kg, either way: a float tells no less

double gate_odds(double gain) {
  return std::max(gain, least_odds) / std::max(1.0 - gain, least_odds);
}

/// Beta-NLL (Seitzer and others 2022) with beta = 0.5 for y_th: its square over 2 sigma^2, weighed by sigma,
/// which is held. For z, of which Kg is the sigmoid, the likelihood itself, y_th held.
StepLoss likelihood_of(const BatchOutputs& of, std::span<float> thermal_gradient,
                       std::span<float> gain_gradient) {
  const std::size_t size = of.thermal.size();
  const double share = 1.0 / static_cast<double>(size);
  double loss = 0.0;
  for (std::size_t i = 0; i < size; ++i) {
    const double error = static_cast<double>(of.thermal[i]) - of.label[i];
    const double sigma = gate_sigma(of.gain[i], gate_gyro_sigma);
    const double square = error * error / (sigma * sigma);
    loss += share * (0.5 * square * sigma + 0.5 * gate_weight * (square - std::log(gate_odds(of.gain[i]))));
    thermal_gradient[i] = static_cast<float>(share * error / sigma);
    gain_gradient[i] =
        static_cast<float>(0.5 * gate_weight * share * (std::min(square, most_surprising) - 1.0));
  }
  return {.loss = loss};
}

}  // namespace

double gate_sigma(double gain, double gyro_sigma) {
  return gyro_sigma / std::sqrt(gate_odds(gain));
}

StepLoss loss_of(const BatchOutputs& outputs, const LossConfig& config, std::span<float> thermal_gradient,
                 std::span<float> gain_gradient) {
  const std::size_t size = outputs.thermal.size();
  const Errors errors = errors_of(outputs);
  PerSample slope{}, auxiliary{};
  const auto first = [size](const PerSample& all) { return std::span(all).first(size); };

  StepLoss result;
  if (config.likelihood && !outputs.gain.empty()) {
    result = likelihood_of(outputs, thermal_gradient, gain_gradient);
    result.squared_error = mean_square(first(errors.fusion));
    result.gain_mean = mean_of(outputs.gain, 1.0);
    return result;
  }
  result.loss = berhu(first(errors.fusion), config.berhu_fraction, slope);
  const double weight = config.auxiliary_thermal;
  if (weight != 0.0) result.loss += weight * berhu(first(errors.thermal), config.berhu_fraction, auxiliary);
  result.squared_error = mean_square(first(errors.fusion));
  result.gain_mean = mean_of(outputs.gain, 1.0);

  for (std::size_t i = 0; i < size; ++i) {
    // Through paper eq. 2: y_fus = Kg * y_th + (1 - Kg) * gyro, Kg = sigmoid(z).
    const double gain = outputs.gain.empty() ? 1.0 : outputs.gain[i];
    thermal_gradient[i] = static_cast<float>(slope[i] * gain + weight * auxiliary[i]);
    if (outputs.gain.empty()) continue;
    const double apart = static_cast<double>(outputs.thermal[i]) - outputs.gyro[i];
    gain_gradient[i] = static_cast<float>(slope[i] * apart * gain * (1.0 - gain));
  }
  return result;
}

}  // namespace thermorig::network
