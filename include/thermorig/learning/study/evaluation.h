// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "thermorig/core/estimate.h"
#include "thermorig/network/gate.h"
#include "thermorig/network/model/model.h"
#include "thermorig/network/window_index.h"

namespace thermorig::study {

// Estimators that are asked for by name: those of the network, and what it is fed with beside images.
inline constexpr std::string_view thermal_name = "cnn-thermal", fusion_name = "cnn-fusion",
                                  kalman_fusion_name = "cnn-fusion-kalman", gyro_name = "gyro",
                                  kalman_name = "gyro-kalman";

/// Who is compared, by the names of the table (estimators/table.h): those of the network, then all that
/// need none.
std::span<const std::string> all_estimators();

/// Those that need no training.
std::span<const std::string> baselines();

/// Index into all_estimators(). There must be one of that name.
std::size_t place_of(std::string_view name);

/// A value for each of all_estimators().
template <typename Value>
class PerEstimator {
 public:
  PerEstimator() : PerEstimator(Value{}) {}
  explicit PerEstimator(const Value& value) : values_(all_estimators().size(), value) {}

  Value& operator[](std::string_view name) { return values_[place_of(name)]; }
  const Value& operator[](std::string_view name) const { return values_[place_of(name)]; }
  const std::vector<Value>& values() const { return values_; }  // in order

 private:
  std::vector<Value> values_;
};

/// A window, and what is said of it beside the truth that it is held against. deg/s; NaN: not known.
struct JudgedWindow {
  network::Window window;
  float label_dps = std::numeric_limits<float>::quiet_NaN();  // mean of the frames' labels
  float shaft_dps = std::numeric_limits<float>::quiet_NaN();  // of the shaft's speeds by the servo model
  PerEstimator<float> rate_dps{std::numeric_limits<float>::quiet_NaN()};
  float gain = std::numeric_limits<float>::quiet_NaN();  // Kg
  float sigma_dps =
      std::numeric_limits<float>::quiet_NaN();  // of the rate from the images, as the gate states it
  float bound_dps = std::numeric_limits<float>::quiet_NaN();  // Cramer-Rao bound of its rate from its images
};

/// What is known of windows of `frames` frames without any network: means over the frames' labels and rates.
std::vector<JudgedWindow> judged_windows(std::span<const network::Acquisition> acquisitions,
                                         std::span<const network::Window> windows, int frames);

/// The same, and what a model says of them, `turned` as training::predict() has it. A thermal-only model says
/// nothing of fusion and Kg.
std::vector<JudgedWindow> judged_windows(const model::Model& model,
                                         std::span<const network::Acquisition> acquisitions,
                                         std::span<const network::Window> windows, int turned = 1);

/// Errors of one estimator over those windows where both it and the label say something. A window without a
/// gyro reading (NaN) is left out of every estimator that needs one, and `windows` is smaller by it; a
/// model's answer to it is NaN as well.
struct Errors {
  std::uint64_t windows = 0;
  double mse = unknown;  // normalised: divided by label_scale_dps^2; NaN without windows, as all that follow
  double rmse_dps = unknown;
  double median_dps = unknown;  // of |error|
  double p95_dps = unknown;
  double outlier_share = unknown;   // |error| > 30 deg/s
  double mean_error_dps = unknown;  // mean error
};

/// Errors at one commanded speed, that of the leg in which the windows lie.
struct SpeedErrors {
  double rate_dps = 0.0;              // signed
  std::uint64_t windows = 0;          // with a label
  PerEstimator<double> mse{unknown};  // normalised; NaN where the estimator says nothing
};

/// Kg over windows (paper Fig. 3).
struct GainStatistics {
  static constexpr std::size_t bins = network::gain_bins;
  std::array<std::uint64_t, bins> histogram{};  // of width 0.05; 1.0 lies in the last
  double mean = unknown, deviation = unknown, median = unknown;
  double below_002 = unknown, above_098 = unknown;  // shares: a collapsed gate

  std::uint64_t windows() const;  // sum of the histogram; 0: all else is NaN
};

/// Has the gate collapsed: is its mean below 0.02 or above 0.98?
bool collapsed(const GainStatistics& gain);

/// Errors in units of what the images of a window tell at best, its Cramer-Rao bound.
struct BoundErrors {
  static constexpr double well_told_dps = 2.0;
  std::uint64_t windows = 0,
                well_told = 0;  // with a label and a bound; of those with one below well_told_dps
  double median_dps = unknown;  // of the bounds
  PerEstimator<double> median{
      unknown};  // of |error| / bound, so scaled that normal errors at the bound give 1
  PerEstimator<double> well_told_rmse{unknown};  // RMSE of the well-told windows by the RMS of their bounds
};

/// Angle by integrating speeds over time (paper Fig. 6), along the windows of one acquisition.
///
/// A window stands for the time between its newest frame and the frame before, which is of the same valid
/// run; its speeds, means over its frames, count for that long. Where no window ends nothing is integrated,
/// so turn-arounds and lost frames are left out, and lines of all Nf of a study are over the same time.
/// Windows without a label are left out. An estimator that says nothing of a window adds nothing to its angle
/// there, and its drift is over the time in which it said something: who says little spoils nobody's line.
/// One that says nothing at all has no line (empty, NaN).
///
/// Figures are of all windows. Lines are thinned out evenly for drawing and rounded (0.01 s, 0.01 deg); they
/// start at 0 and end at the end.
struct AngleTrack {
  double integrated_s = 0.0;
  std::vector<double> time_s;  // integrated time, from 0
  std::vector<double> commanded_deg;
  PerEstimator<std::vector<double>> error_deg;      // integrated estimate minus commanded
  PerEstimator<double> drift_deg_per_min{unknown};  // slope of error_deg, least squares through 0
  PerEstimator<double> worst_deg{unknown};          // largest |error_deg|
  // The same with all angles at 0 at settled_s after the acquisition's first frame: without what starts.
  static constexpr double settled_s = 30.0;
  PerEstimator<double> settled_drift_deg_per_min{unknown}, settled_worst_deg{unknown};
};

/// What a gate states of the rate from the images, beside its errors against the shaft, and what the fusion
/// is worth whichever gyro the windows happen to have.
struct GateSigma {
  std::uint64_t windows = 0;
  double median_dps = unknown;  // of the sigmas stated
  double within_one = unknown,
         within_two = unknown;                    // shares of the errors; 0.68 and 0.95 if they were normal
  double gain_p05 = unknown, gain_p95 = unknown;  // quantiles of Kg
  double fusion_rmse_dps = unknown;  // in expectation over a gyro that is off by 10 deg/s (one sigma)
};
inline constexpr double expected_gyro_dps = 10.0;

/// The acquisitions of one environment together.
struct EnvironmentErrors {
  std::string name;
  std::size_t acquisitions = 0;
  PerEstimator<Errors> errors;
  PerEstimator<Errors> shaft_errors;
  std::optional<GateSigma> sigma;
};

/// A model, or a fold's model, on the windows of one or more acquisitions.
struct Evaluation {
  PerEstimator<Errors> errors;                  // against the label
  PerEstimator<Errors> shaft_errors;            // against the shaft by the servo model
  std::vector<EnvironmentErrors> environments;  // by name; not kept in a study's results
  std::vector<SpeedErrors> speeds;              // ascending
  GainStatistics gain;                          // empty for a thermal-only model
  std::vector<AngleTrack> angles;               // one an acquisition, in order
  std::vector<std::string> names;               // of the acquisitions
  std::optional<GateSigma> sigma;               // where the gate states one; not kept in a study's results
  std::optional<BoundErrors> bounds;  // where the acquisitions have any; not kept in a study's results
  bool simulated = false;             // any of them
};

/// What evaluate() cannot tell from the windows.
struct EvaluationConfig {
  double label_scale_dps = 200.0;  // above 0
  std::size_t angle_points = 300;  // at most so many points a line, at least 2
};

/// Evaluates rates against labels. `acquisitions` are those that the windows point into; windows are in
/// ascending order, by acquisition and newest frame. Deterministic.
Evaluation evaluate(std::span<const JudgedWindow> judged, std::span<const network::Acquisition> acquisitions,
                    const EvaluationConfig& config = {});

/// Median and interquartile range (linear interpolation between order statistics, as NumPy's default). NaN
/// without values; values that are NaN are left out.
struct Spread {
  double median = 0.0;
  double iqr = 0.0;
};
Spread spread_of(std::vector<double> values);

}  // namespace thermorig::study
