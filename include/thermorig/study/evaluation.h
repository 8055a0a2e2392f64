// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "thermorig/training/prediction.h"

namespace thermorig::study {

/// Errors of one estimator over some windows.
struct Errors {
  std::uint64_t windows = 0;
  double mse = 0.0;  // normalised: divided by label_scale_dps^2; NaN without windows, as all that follow
  double rmse_dps = 0.0;
  double median_dps = 0.0;  // of |error|
  double p95_dps = 0.0;
  double outlier_share = 0.0;  // |error| > 30 deg/s
  double bias_dps = 0.0;       // mean error
};

/// Who estimates. `gyro` is the mean gyro of the window as it is; `gyro_unbiased` the same less the mean over
/// the opening rest.
enum class Estimator : std::uint8_t { thermal, fusion, gyro, gyro_unbiased };
inline constexpr std::size_t estimator_count = 4;
inline constexpr std::array<Estimator, estimator_count> all_estimators{
    Estimator::thermal, Estimator::fusion, Estimator::gyro, Estimator::gyro_unbiased};
std::string name_of(Estimator estimator);  // "thermal-only", "fusion", "gyro", "gyro, static bias removed"

/// Errors at one commanded speed.
struct SpeedErrors {
  double rate_dps = 0.0;  // signed
  std::uint64_t windows = 0;
  std::array<double, estimator_count> mse{};
};

/// Kg over windows (paper Fig. 3).
struct GainStatistics {
  static constexpr std::size_t bins = 20;
  std::array<std::uint64_t, bins> histogram{};  // of width 0.05
  double mean = 0.0, deviation = 0.0, median = 0.0;
  double below_002 = 0.0, above_098 = 0.0;  // shares: a collapsed gate
};

/// Angle by integrating speeds over time (paper Fig. 6), along the windows of one acquisition; where frames
/// are missing or not valid nothing is integrated, so every line is over the same spans. Decimated for
/// drawing.
struct AngleTrack {
  std::vector<double> time_s;  // integrated time, from 0
  std::vector<double> commanded_deg;
  std::array<std::vector<double>, estimator_count> error_deg;  // integrated estimate minus commanded
  std::array<double, estimator_count> drift_deg_per_min{};     // slope of error_deg, least squares through 0
  std::array<double, estimator_count> worst_deg{};             // largest |error_deg|
};

/// A model, or a fold's model, on the windows of one or more acquisitions.
struct Evaluation {
  std::array<Errors, estimator_count> errors;
  std::vector<SpeedErrors> speeds;  // ascending
  GainStatistics gain;              // empty for a thermal-only model
  std::vector<AngleTrack> angles;   // one an acquisition, in order
  std::vector<std::string> names;   // of the acquisitions
};

/// Evaluates estimates against labels. `acquisitions` are those that the estimates' windows point into.
Evaluation evaluate(std::span<const training::WindowEstimate> estimates,
                    std::span<const windows::Acquisition> acquisitions, double label_scale_dps);

/// Median and interquartile range (linear interpolation between order statistics, as NumPy's default).
struct Spread {
  double median = 0.0;
  double iqr = 0.0;
};
Spread spread_of(std::vector<double> values);

}  // namespace thermorig::study
