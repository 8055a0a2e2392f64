// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "thermorig/estimators/errors.h"
#include "thermorig/learning/study/evaluation.h"

namespace thermorig::study {

inline constexpr double outlier_dps = 30.0;

/// Collects errors; those that are not finite are left out.
class ErrorStatistics {
 public:
  void add(double error_dps);
  Errors errors(double label_scale_dps);

 private:
  estimators::RateErrors sums_;
  std::uint64_t outliers_ = 0;
  std::vector<double> magnitudes_;
};

/// Errors by the commanded speed of the leg that a window's newest frame lies in.
std::vector<SpeedErrors> speed_errors(std::span<const JudgedWindow> judged,
                                      std::span<const network::Acquisition> acquisitions,
                                      double label_scale_dps);

}  // namespace thermorig::study
