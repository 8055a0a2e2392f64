// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "thermorig/training/prediction.h"

namespace thermorig::study {

/// Errors of one estimator over those windows where both it and the label say something. A window without a
/// gyro reading (NaN) is left out of every estimator that needs one, and `windows` is smaller by it; a
/// model's answer to it is NaN as well.
struct Errors {
  std::uint64_t windows = 0;
  double mse = 0.0;  // normalised: divided by label_scale_dps^2; NaN without windows, as all that follow
  double rmse_dps = 0.0;
  double median_dps = 0.0;  // of |error|
  double p95_dps = 0.0;
  double outlier_share = 0.0;  // |error| > 30 deg/s
  double bias_dps = 0.0;       // mean error
};

/// Who estimates. `gyro` is the mean gyro of the window as it is; `gyro_unbiased` the same less the static
/// bias that it showed at rest before the first leg. Where there was no rest it is unknown, which is no
/// windows and NaN.
enum class Estimator : std::uint8_t { thermal, fusion, gyro, gyro_unbiased };
inline constexpr std::size_t estimator_count = 4;
inline constexpr std::array<Estimator, estimator_count> all_estimators{
    Estimator::thermal, Estimator::fusion, Estimator::gyro, Estimator::gyro_unbiased};
std::string name_of(Estimator estimator);  // "thermal-only", "fusion", "gyro", "gyro, static bias removed"

std::string field_name_of(Estimator estimator);  // "thermal", "fusion", "gyro", "gyro_unbiased": for files

/// Errors at one commanded speed, that of the leg in which the windows lie.
struct SpeedErrors {
  double rate_dps = 0.0;                      // signed
  std::uint64_t windows = 0;                  // with a label
  std::array<double, estimator_count> mse{};  // normalised; NaN where the estimator says nothing
};

/// Kg over windows (paper Fig. 3).
struct GainStatistics {
  static constexpr std::size_t bins = 20;
  std::array<std::uint64_t, bins> histogram{};  // of width 0.05; 1.0 lies in the last
  double mean = 0.0, deviation = 0.0, median = 0.0;
  double below_002 = 0.0, above_098 = 0.0;  // shares: a collapsed gate

  std::uint64_t windows() const;  // sum of the histogram; 0: all else is NaN
};

/// Has the gate collapsed: is its mean below 0.02 or above 0.98?
bool collapsed(const GainStatistics& gain);

/// Angle by integrating speeds over time (paper Fig. 6), along the windows of one acquisition.
///
/// A window stands for the time between its newest frame and the frame before, which is of the same valid
/// run; its speeds, means over its frames, count for that long. Where no window ends nothing is integrated,
/// so turn-arounds and lost frames are left out, and lines of all Nf of a study are over the same time.
/// Windows where the label or an estimator is NaN are left out for all, unless it is NaN in every window of
/// the acquisition: then that estimator alone has no line (empty, NaN).
///
/// Figures are of all windows. Lines are thinned out evenly for drawing and rounded (0.01 s, 0.01 deg); they
/// start at 0 and end at the end.
struct AngleTrack {
  double integrated_s = 0.0;
  std::vector<double> time_s;  // integrated time, from 0
  std::vector<double> commanded_deg;
  std::array<std::vector<double>, estimator_count> error_deg;  // integrated estimate minus commanded
  std::array<double, estimator_count> drift_deg_per_min{};     // slope of error_deg, least squares through 0
  std::array<double, estimator_count> worst_deg{};             // largest |error_deg|
};

/// The acquisitions of one environment together.
struct EnvironmentErrors {
  std::string name;
  std::size_t acquisitions = 0;
  std::array<Errors, estimator_count> errors;
};

/// A model, or a fold's model, on the windows of one or more acquisitions.
struct Evaluation {
  std::array<Errors, estimator_count> errors;
  std::vector<EnvironmentErrors> environments;  // by name; not kept in a study's results
  std::vector<SpeedErrors> speeds;              // ascending
  GainStatistics gain;                          // empty for a thermal-only model
  std::vector<AngleTrack> angles;               // one an acquisition, in order
  std::vector<std::string> names;               // of the acquisitions
  bool simulated = false;                       // any of them
};

/// What evaluate() cannot tell from the estimates.
struct EvaluationConfig {
  double label_scale_dps = 200.0;  // above 0
  bool fusion = true;              // false: a thermal-only model, of which `fusion` and Kg say nothing
  std::size_t angle_points = 300;  // at most so many points a line, at least 2
};

/// Evaluates estimates against labels. `acquisitions` are those that the estimates' windows point into, the
/// windows of an acquisition in ascending order. Deterministic.
Evaluation evaluate(std::span<const training::WindowEstimate> estimates,
                    std::span<const windows::Acquisition> acquisitions, const EvaluationConfig& config);

/// The same with the rest as it is by default.
inline Evaluation evaluate(std::span<const training::WindowEstimate> estimates,
                           std::span<const windows::Acquisition> acquisitions, double label_scale_dps) {
  return evaluate(estimates, acquisitions, EvaluationConfig{.label_scale_dps = label_scale_dps});
}

/// Median and interquartile range (linear interpolation between order statistics, as NumPy's default). NaN
/// without values; values that are NaN are left out.
struct Spread {
  double median = 0.0;
  double iqr = 0.0;
};
Spread spread_of(std::vector<double> values);

}  // namespace thermorig::study
