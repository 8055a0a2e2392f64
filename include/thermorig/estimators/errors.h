// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "thermorig/core/estimate.h"

namespace thermorig::estimators {

/// Errors of a rate, estimate less label, added up: the figures of live runs, of a model on sessions and of a
/// study. Figures are NaN without errors.
class RateErrors {
 public:
  /// `error_dps`: finite.
  void add(double error_dps) {
    ++count_;
    sum_ += error_dps;
    squares_ += error_dps * error_dps;
  }

  std::uint64_t count() const { return count_; }
  double mean_dps() const { return of_each(sum_); }
  double rmse_dps() const { return std::sqrt(of_each(squares_)); }

  /// Divided by the square of `scale_dps`.
  double mse(double scale_dps) const { return of_each(squares_) / (scale_dps * scale_dps); }

 private:
  double of_each(double sum) const { return count_ > 0 ? sum / static_cast<double>(count_) : unknown; }

  std::uint64_t count_ = 0;
  double sum_ = 0.0, squares_ = 0.0;
};

/// The error of an angle that errors of a rate add up to. Times are those of the errors that were added.
class AngleError {
 public:
  /// The rate was wrong by so much for so long: finite, at least 0 s.
  void add(double error_dps, double duration_s) {
    has_begun_ = true;
    angle_deg_ += error_dps * duration_s;
    integrated_s_ += duration_s;
    products_ += integrated_s_ * angle_deg_;
    squares_ += integrated_s_ * integrated_s_;
    worst_deg_ = std::max(worst_deg_, std::abs(angle_deg_));
  }

  bool has_begun() const { return has_begun_; }
  double angle_deg() const { return angle_deg_; }
  double integrated_s() const { return integrated_s_; }
  double worst_deg() const { return has_begun_ ? worst_deg_ : unknown; }  // largest magnitude

  /// The error of now over the time; NaN of no time.
  double drift_deg_per_min() const {
    return integrated_s_ > 0.0 ? seconds_a_minute * angle_deg_ / integrated_s_ : unknown;
  }

  /// Slope of the straight line through 0 that fits the error over time best; NaN of no time.
  double slope_deg_per_min() const {
    return squares_ > 0.0 ? seconds_a_minute * products_ / squares_ : unknown;
  }

 private:
  static constexpr double seconds_a_minute = 60.0;
  bool has_begun_ = false;
  double angle_deg_ = 0.0, integrated_s_ = 0.0, worst_deg_ = 0.0;
  double products_ = 0.0, squares_ = 0.0;  // of time and error, of time
};

}  // namespace thermorig::estimators
