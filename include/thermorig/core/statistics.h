// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <ranges>
#include <span>
#include <vector>

namespace thermorig {

/// The value that stands at `rank` (from 0) once they are sorted; they are put in another order. There is
/// one.
template <std::ranges::random_access_range Values>
std::ranges::range_value_t<Values> value_of_rank(Values&& values, std::size_t rank) {
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

/// The one below which `share` (0..1) of the values lie, rounded down to one of them; they are put in another
/// order. 0 of none.
template <std::ranges::random_access_range Values>
std::ranges::range_value_t<Values> lower_quantile(Values&& values, double share) {
  if (std::ranges::empty(values)) return {};
  const double rank = share * static_cast<double>(std::ranges::size(values) - 1);
  return value_of_rank(values, static_cast<std::size_t>(std::floor(rank)));
}

/// The same, rounded up.
template <std::ranges::random_access_range Values>
std::ranges::range_value_t<Values> upper_quantile(Values&& values, double share) {
  if (std::ranges::empty(values)) return {};
  const double rank = share * static_cast<double>(std::ranges::size(values) - 1);
  return value_of_rank(values, static_cast<std::size_t>(std::ceil(rank)));
}

/// The middle value; of an even number, the upper one of the two in the middle. They are put in another
/// order. 0 of none.
template <std::ranges::random_access_range Values>
std::ranges::range_value_t<Values> reordering_median(Values&& values) {
  if (std::ranges::empty(values)) return {};
  return value_of_rank(values, std::ranges::size(values) / 2);
}

/// The same of a copy.
double median(std::vector<double> values);

/// Standard deviation about `centre` as the middle half of the values has it: 1.4826 times the median
/// absolute deviation.
double robust_deviation(std::vector<double> values, double centre);

/// The value below which `share` (0..1) of the sorted values lie: linear interpolation between order
/// statistics, as NumPy's default. NaN of none.
double quantile(std::span<const double> sorted, double share);

/// Whether something happens more than now and then: of the last hundred times or so, older ones forgotten
/// bit by bit.
class RecentCount {
 public:
  void add(bool happened) { value_ = kept * value_ + (happened ? 1.0 : 0.0); }
  bool is_frequent() const { return value_ > frequent; }

 private:
  static constexpr double kept = 0.99;     // each time
  static constexpr double frequent = 2.0;  // of the last hundred
  double value_ = 0.0;
};

/// Mean and variance of numbers as they come (Welford's algorithm).
class RunningStatistics {
 public:
  void add(double value) {
    ++count_;
    const double off = value - mean_;
    mean_ += off / static_cast<double>(count_);
    squares_ += off * (value - mean_);
  }

  std::size_t count() const { return count_; }
  double mean() const { return mean_; }  // 0 without numbers

  /// Of the distribution that the numbers were drawn from: divided by count - 1. 0 for less than two.
  double sample_variance() const { return count_ < 2 ? 0.0 : squares_ / static_cast<double>(count_ - 1); }

  /// Of the numbers themselves: divided by count. 0 without numbers.
  double variance() const { return count_ == 0 ? 0.0 : squares_ / static_cast<double>(count_); }

 private:
  std::size_t count_ = 0;
  double mean_ = 0.0, squares_ = 0.0;
};

/// The straight line that fits points (x, y) best, by weighted least squares.
class LineFit {
 public:
  void add(double x, double y, double weight = 1.0) {
    if (weights_ == 0.0) {  // sums are about the first point: points may lie far from 0
      first_x_ = x;
      first_y_ = y;
    }
    const double off_x = x - first_x_, off_y = y - first_y_;
    weights_ += weight;
    x_ += weight * off_x;
    y_ += weight * off_y;
    xx_ += weight * off_x * off_x;
    xy_ += weight * off_x * off_y;
    yy_ += weight * off_y * off_y;
  }

  double weights() const { return weights_; }
  double mean_x() const { return first_x_ + x_ / weights_; }  // of one point at least
  double mean_y() const { return first_y_ + y_ / weights_; }

  /// Weighted squares about the mean; 0 without points.
  double squares_x() const { return std::max(0.0, about_mean(xx_, x_ * x_)); }
  double squares_y() const { return std::max(0.0, about_mean(yy_, y_ * y_)); }

  /// 0 where all x are the same.
  double slope() const { return squares_x() > 0.0 ? about_mean(xy_, x_ * y_) / squares_x() : 0.0; }

  double at(double x) const { return mean_y() + slope() * (x - mean_x()); }

  /// Weighted squares of y less the line.
  double residual_squares() const { return std::max(0.0, squares_y() - slope() * slope() * squares_x()); }

  /// -1..1; 0 where all x or all y are the same.
  double correlation() const {
    return squares_y() > 0.0 ? slope() * std::sqrt(squares_x() / squares_y()) : 0.0;
  }

 private:
  double about_mean(double products, double sums) const {
    return weights_ > 0.0 ? products - sums / weights_ : 0.0;
  }

  double first_x_ = 0.0, first_y_ = 0.0;
  double weights_ = 0.0, x_ = 0.0, y_ = 0.0, xx_ = 0.0, xy_ = 0.0, yy_ = 0.0;
};

}  // namespace thermorig
