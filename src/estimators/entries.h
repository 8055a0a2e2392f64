// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "thermorig/estimators/table.h"
#include "thermorig/network/last_blocks.h"
#include "thermorig/network/window_index.h"

namespace thermorig::estimators {

/// Entry::make of an estimator of that class.
template <typename Made>
std::unique_ptr<Estimator> made(const Setup& setup) {
  return std::make_unique<Made>(setup);
}

/// Why an entry cannot run with a model, or without one.
struct Lack {
  const char *needs, *advice;
};
std::optional<Lack> lack_of(const Entry& entry, const std::optional<model::Model>& model);

/// Rates of the last frames, and their mean: unknown (NaN) before there were so many, and where one is.
class WindowRates {
 public:
  explicit WindowRates(int frames) : rates_dps_(static_cast<std::size_t>(frames), 1) {}

  /// The next frame's rate; returns the mean of the window that it ends.
  float add(float rate_dps) {
    rates_dps_.push(rate_dps);
    return network::mean_rate(rates_dps_.all());
  }

 private:
  network::LastBlocks rates_dps_;
};

// Each in the file of its name; those of the network in network_estimators.cpp.
Entry gyro();
Entry gyro_rest();
Entry gyro_kalman();
Entry odometer();
Entry thermal_likelihood();
Entry cnn_thermal();
Entry cnn_fusion();
Entry cnn_fusion_kalman();

}  // namespace thermorig::estimators
