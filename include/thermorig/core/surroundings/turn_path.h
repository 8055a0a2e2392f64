// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace thermorig {

/// What a shaft may have turned by beside a straight line through both ends of a time in which nothing
/// measured it, one standard deviation: it may have left its speed and come back to it.
inline double unseen_deg(double gap_s) {
  constexpr double acceleration_dps2 = 2000.0;
  constexpr double speed_dps = 200.0;
  return std::min(acceleration_dps2 * gap_s * gap_s / 16.0, speed_dps * gap_s);
}

/// How much of the time between two samples was lost: a sample is the mean over its period.
inline double lost_s(double step_s, double period_s) {
  return step_s > 1.5 * period_s ? step_s - period_s : 0.0;
}

/// What the gyro turned by while a chess half was exposed, bias and scale not removed: enough to know the
/// mean heading and its spread for any bias and scale. Times in seconds of the gyro's path.
struct ExposedTurn {
  double begin_s = 0.0, end_s = 0.0;
  double begin_deg = 0.0, end_deg = 0.0;  // integral of the readings
  double mean_s = 0.0, mean_deg = 0.0;    // over the exposure
  double variance_s2 = 0.0, variance_deg2 = 0.0, covariance = 0.0;
  double change_dps = 0.0;                 // of the reading, from the first third to the last
  double first_dps = 0.0, last_dps = 0.0;  // readings at both ends

  double length_s() const { return end_s - begin_s; }
  double mean_read_dps() const { return (end_deg - begin_deg) / length_s(); }
};

/// The gyro's integral: what it has turned by, bias and scale not removed. A sample stands for the instant of
/// its stamp; between two the rate is a straight line.
class TurnPath {
 public:
  /// `kept`: samples, at least 1; more are forgotten from the oldest on.
  explicit TurnPath(std::size_t kept = a_minute) : kept_(kept), knots_(kept) {}

  struct Knot {
    double time_s = 0.0;
    double turned_deg = 0.0;
    double rate_dps = 0.0;
    double unseen_deg2 = 0.0;  // variance of what was turned while nothing measured it
    double sum_deg_s = 0.0;    // integral of what was turned
  };

  /// Times grow. `unseen_deg2`: of the step from the sample before.
  void add(double time_s, double rate_dps, double unseen_deg2 = 0.0);
  void clear() { count_ = 0; }

  bool has_begun() const { return count_ > 0; }
  double begin_s() const { return at(first()).time_s; }
  const Knot& newest() const { return at(count_ - 1); }

  /// At any time; after the newest sample its rate goes on, and before the oldest that is kept its was.
  Knot until(double time_s) const;
  /// What it has turned by at times that grow by `step_s`: faster than each of them alone.
  void turned(double from_s, double step_s, std::span<double> turned_deg) const;
  ExposedTurn over(double begin_s, double end_s) const;

  struct Mean {
    double turned_deg = 0.0;
    double rate_dps = 0.0;
  };
  /// Over the interval, for a look-up at either end, whatever its length: the angle is taken for a straight
  /// line between samples, and to stay where it is beyond the first and the last of them.
  Mean mean_over(double begin_s, double end_s) const;

 private:
  static constexpr std::size_t a_minute = 16384;
  const Knot& at(std::size_t place) const { return knots_[place < kept_ ? place : place % kept_]; }
  std::size_t first() const { return count_ > kept_ ? count_ - kept_ : 0; }
  std::size_t after(double time_s) const;
  std::size_t after(double time_s, std::size_t from) const;
  Knot until(double time_s, std::size_t later) const;
  Knot along_chords(double time_s) const;

  std::size_t kept_;
  std::vector<Knot> knots_;
  std::size_t count_ = 0;
};

}  // namespace thermorig
