// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

namespace thermorig {

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

}  // namespace thermorig
