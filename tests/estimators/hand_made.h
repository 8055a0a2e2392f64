// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "thermorig/core/measurement.h"
#include "thermorig/estimators/table.h"
#include "thermorig/network/model/model.h"

namespace thermorig::estimators {

/// A rig by functions of time in seconds: what its gyro reads and what its servo is told.
struct HandMadeRig {
  double duration_s = 10.0;
  std::function<float(double)> gyro_dps = [](double) { return 0.0F; };  // about the servo's axis
  std::function<bool(double)> is_told_to_move = [](double) { return false; };
  std::function<bool(double)> has_gyro = [](double) { return true; };  // a sample is lost where not
  bool has_servo = true;
  double noise_dps = 0.05;
  double exposure_s = 0.25;
};

/// 8 frames a second, 200 gyro samples a second, each the rate at its time, and 100 states of the servo. The
/// images change from frame to frame; labels are not known.
std::vector<Measurement> measurements_of(const HandMadeRig& rig);

/// At rest for `rest_s`, then a speed, with a bias on all of it.
HandMadeRig rest_and_speed(double rest_s, double speed_dps, double bias_dps);

/// Noise is small, scale and bias are sure, so that arithmetic shows.
GyroProfile exact_gyro();

Bank bank_of(const std::string& name, const GyroProfile& gyro,
             const std::optional<model::Model>& model = std::nullopt);

/// Each measurement's estimate by the bank's first estimator.
std::vector<RateEstimate> estimates_of(Bank& bank, const std::vector<Measurement>& measurements);
std::vector<RateEstimate> estimates_of(const std::string& name, const GyroProfile& gyro,
                                       const std::vector<Measurement>& measurements);

/// Each measurement's estimates by all of them.
std::vector<std::vector<RateEstimate>> all_estimates_of(Bank& bank,
                                                        const std::vector<Measurement>& measurements);

/// A network of seeded weights that has seen no training.
model::Model untrained_model(const network::Shape& shape = {});
/// Which scales each window, and whose gate states a sigma.
model::Model untrained_model_with_sigma();

/// Bit for bit: an unknown number equals the same unknown number.
bool are_same(const RateEstimate& a, const RateEstimate& b);
bool are_same(std::span<const RateEstimate> a, std::span<const RateEstimate> b);

}  // namespace thermorig::estimators
