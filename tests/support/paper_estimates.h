// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "thermorig/core/estimate_row.h"

namespace thermorig {

inline constexpr float unknown_dps = std::numeric_limits<float>::quiet_NaN();

/// The estimators of the paper, where tests look for them in a row.
inline const std::vector<EstimatorColumn> paper_columns{{.name = "gyro", .values = {}},
                                                        {.name = "cnn-thermal", .values = {}},
                                                        {.name = "cnn-fusion", .values = {"gain"}}};
enum PaperEstimator : std::size_t { of_gyro, of_thermal, of_fusion };

inline float& gyro_dps(EstimateRow& row) {
  return row.estimates[of_gyro].rate_dps;
}
inline float gyro_dps(const EstimateRow& row) {
  return row.estimates[of_gyro].rate_dps;
}
inline float& thermal_dps(EstimateRow& row) {
  return row.estimates[of_thermal].rate_dps;
}
inline float thermal_dps(const EstimateRow& row) {
  return row.estimates[of_thermal].rate_dps;
}
inline float& fusion_dps(EstimateRow& row) {
  return row.estimates[of_fusion].rate_dps;
}
inline float fusion_dps(const EstimateRow& row) {
  return row.estimates[of_fusion].rate_dps;
}
inline float& kg(EstimateRow& row) {
  return row.estimates[of_fusion].values[0];
}
inline float kg(const EstimateRow& row) {
  return row.estimates[of_fusion].values[0];
}

/// The row with what these three say.
inline EstimateRow with_rates(EstimateRow row, float gyro, float thermal, float fusion, float gain) {
  row.estimates[of_gyro] = rate_only(gyro);
  row.estimates[of_thermal] = rate_only(thermal);
  row.estimates[of_fusion] = rate_only(fusion);
  kg(row) = gain;
  return row;
}

}  // namespace thermorig
