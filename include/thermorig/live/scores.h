// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "thermorig/core/live_estimate.h"

namespace thermorig::live {

enum class Rate : std::uint8_t { thermal, gyro, fusion };
inline constexpr std::size_t rate_count = 3;

/// Of one estimator against the label. MSEs are normalised (divided by label_scale_dps squared); NaN without
/// frames.
struct RateScores {
  std::uint64_t frames = 0;        // counted, where this estimator said something
  double mse = 0.0;                // over the whole run
  double rmse_dps = 0.0;           // over the whole run
  std::uint64_t recent = 0;        // frames of the last minute
  double recent_median_mse = 0.0;  // median of the squared errors of the last minute
  double recent_iqr_mse = 0.0;     // and their interquartile range
  double angle_error_deg = 0.0;  // integral of estimate minus label since the last reset; NaN without frames
  double drift_deg_per_min = 0.0;  // angle_error_deg over the integrated time; NaN before the first second
};

/// The figures of the screen. Frames that are not `counted` are shown and counted apart, and enter no figure.
struct LiveScores {
  std::uint64_t frames = 0;  // all
  std::uint64_t counted = 0;
  std::uint64_t apart = 0;    // not counted
  double integrated_s = 0.0;  // since the last reset
  std::array<RateScores, rate_count> rates;
  std::array<std::uint64_t, 20> gain_histogram{};  // Kg of the counted frames, bins of 0.05
  double gain_mean = 0.0;                          // NaN without a fusion estimate
  /// Kg stays below 0.02, or above 0.98: in each of the last 64 counted frames that have one.
  bool gate_collapsed = false;
};

/// Follows a live run row by row. A counted window stands for the time since the frame before, if that is of
/// the same run: so angles are integrated as study::AngleTrack does it. "Last minute" is by the rows' times.
/// Memory is bounded: the last minute's errors and sums. The same rows give
/// the same figures to the last digit, on the screen and from a file.
class Scorer {
 public:
  explicit Scorer(double label_scale_dps = 200.0);
  ~Scorer();
  Scorer(Scorer&&) noexcept;
  Scorer& operator=(Scorer&&) noexcept;

  void add(const LiveEstimate& row);
  void reset_angle();
  LiveScores scores() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace thermorig::live
