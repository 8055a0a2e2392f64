// SPDX-License-Identifier: MIT
#include "thermorig/learning/training/fit.h"

#include "held_out.h"
#include "thermorig/learning/training/prediction.h"

namespace thermorig::training {

namespace {

/// Square of the difference, normalised.
double square(float estimate_dps, const WindowEstimate& window, double scale_dps) {
  const double error = (static_cast<double>(estimate_dps) - window.label_dps) / scale_dps;
  return error * error;
}

void add(Fit& fit, const WindowEstimate& window, double scale_dps) {
  fit.network_mse += square(window.fusion_dps, window, scale_dps);
  fit.thermal_mse += square(window.thermal_dps, window, scale_dps);
  fit.gyro_mse += square(window.gyro_dps, window, scale_dps);
  fit.gain_mean += window.gain;
  if (window.gain < network::closed_gate) fit.gain_below_002 += 1.0;
  if (window.gain > network::open_gate) fit.gain_above_098 += 1.0;
}

Fit fit_of(const model::Model& model, std::span<const network::Acquisition> acquisitions,
           const std::vector<network::Window>& windows) {
  Fit fit{.windows = windows.size(), .gain_mean = 0.0};
  if (windows.empty()) return {};
  for (const WindowEstimate& window : predict(model, acquisitions, windows))
    add(fit, window, model.scaling.label_scale_dps);
  for (double* sum : {&fit.network_mse, &fit.thermal_mse, &fit.gyro_mse, &fit.gain_mean, &fit.gain_below_002,
                      &fit.gain_above_098})
    *sum /= static_cast<double>(windows.size());
  return fit;
}

}  // namespace

Fits fits_of(const model::Model& model, const TrainingConfig& config,
             std::span<const network::Acquisition> acquisitions) {
  const Division division = divide(config, acquisitions);
  Fits fits{.training = fit_of(model, acquisitions, division.training)};
  if (!division.held_out.empty()) fits.held_out = fit_of(model, acquisitions, division.held_out);
  return fits;
}

}  // namespace thermorig::training
