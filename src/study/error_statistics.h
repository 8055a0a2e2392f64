// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "thermorig/study/evaluation.h"

namespace thermorig::study {

inline constexpr double outlier_dps = 30.0;

/// Collects errors; those that are not finite are left out.
class ErrorStatistics {
 public:
  explicit ErrorStatistics(double label_scale_dps) : scale_dps_(label_scale_dps) {}
  void add(double error_dps);
  Errors errors();

 private:
  double scale_dps_;
  double sum_ = 0.0, squares_ = 0.0;
  std::uint64_t outliers_ = 0;
  std::vector<double> magnitudes_;
};

/// Errors by the commanded speed of the leg that a window's newest frame lies in.
std::vector<SpeedErrors> speed_errors(std::span<const training::WindowEstimate> estimates,
                                      std::span<const windows::Acquisition> acquisitions,
                                      const EvaluationConfig& config);

}  // namespace thermorig::study
