// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "thermorig/core/estimate_row.h"
#include "thermorig/network/gate.h"

namespace thermorig::live {

/// Kg in a row, NaN where it is not known; nothing where no estimator has a value "gain".
std::optional<float> gain_of(std::span<const EstimatorColumn> estimators, const EstimateRow& row);

/// Of one estimator against the label. MSEs are normalised (divided by label_scale_dps squared); NaN without
/// frames.
struct EstimatorScores {
  std::string name;
  std::uint64_t frames = 0;        // counted, where this estimator said something
  double mse = 0.0;                // over the whole run
  double rmse_dps = 0.0;           // over the whole run
  std::uint64_t recent = 0;        // frames of the last minute
  double recent_median_mse = 0.0;  // median of the squared errors of the last minute
  double recent_iqr_mse = 0.0;     // and their interquartile range
  double angle_error_deg = 0.0;  // integral of estimate minus label since the last reset; NaN without frames
  double drift_deg_per_min = 0.0;  // angle_error_deg over the integrated time; NaN before the first second
};

/// The figures of the screen. Frames that are not `counted` are shown, and excluded from every figure.
struct LiveScores {
  std::uint64_t frames = 0;  // all
  std::uint64_t counted = 0;
  std::uint64_t excluded = 0;                                      // not counted
  double integrated_s = 0.0;                                       // since the last reset
  std::vector<EstimatorScores> estimators;                         // in the rows' order
  std::array<std::uint64_t, network::gain_bins> gain_histogram{};  // Kg of the counted frames
  double gain_mean = 0.0;                                          // NaN where no estimator has a gate
  /// Kg stays below 0.02, or above 0.98: in each of the last 64 counted frames that have one.
  bool gate_collapsed = false;
};

/// Follows a live run row by row. A counted window stands for the time since the frame before, if that is of
/// the same run, as in study::AngleTrack; the sums are the same too (estimators/errors.h). "Last minute" is
/// by the rows' times. Memory is bounded: the last minute's errors and sums. The same rows give the same
/// figures to the last digit, on the screen and from a file.
class Scorer {
 public:
  /// `estimators`: of the rows. The gate's figures are of the first that has a value "gain".
  explicit Scorer(std::span<const EstimatorColumn> estimators, double label_scale_dps = 200.0);
  ~Scorer();
  Scorer(Scorer&&) noexcept;
  Scorer& operator=(Scorer&&) noexcept;

  void add(const EstimateRow& row);
  LiveScores scores() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace thermorig::live
