// SPDX-License-Identifier: MIT
#pragma once

#include <deque>
#include <vector>

#include "thermorig/core/time.h"

namespace thermorig::live {

/// Squared errors of the last minute, in order of time and in order of size.
class RecentErrors {
 public:
  void add(HostTime time, double squared);

  /// Forgets what is a minute or more before `now`.
  void forget_before(HostTime now);

  const std::vector<double>& sorted() const { return sorted_; }

 private:
  struct Entry {
    HostTime time{};
    double squared = 0.0;
  };
  void forget_oldest();

  std::deque<Entry> entries_;
  std::vector<double> sorted_;
};

}  // namespace thermorig::live
