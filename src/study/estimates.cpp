// SPDX-License-Identifier: MIT
#include "estimates.h"

#include <limits>

namespace thermorig::study {

double speed_of(const training::WindowEstimate& estimate, Estimator estimator,
                std::span<const windows::Acquisition> acquisitions, bool fusion) {
  switch (estimator) {
    case Estimator::thermal:
      return estimate.thermal_dps;
    case Estimator::fusion:
      return fusion ? double{estimate.fusion_dps} : std::numeric_limits<double>::quiet_NaN();
    case Estimator::gyro:
      return estimate.gyro_dps;
    case Estimator::gyro_unbiased:
      return double{estimate.gyro_dps} - acquisitions[estimate.window.acquisition].rest_bias_dps;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace thermorig::study
