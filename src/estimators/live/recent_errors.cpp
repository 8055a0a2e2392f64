// SPDX-License-Identifier: MIT
#include "recent_errors.h"

#include <algorithm>

#include "seconds_between.h"

namespace thermorig::live {

namespace {

constexpr double minute_s = 60.0;
constexpr std::size_t most_entries = 60'000;  // 1000 frames/s: only a file whose times stand still has more

}  // namespace

void RecentErrors::add(HostTime time, double squared) {
  if (entries_.size() == most_entries) forget_oldest();
  entries_.push_back({time, squared});
  sorted_.insert(std::upper_bound(sorted_.begin(), sorted_.end(), squared), squared);
}

void RecentErrors::forget_before(HostTime now) {
  while (!entries_.empty() && seconds_between(entries_.front().time, now) >= minute_s) forget_oldest();
}

void RecentErrors::forget_oldest() {
  sorted_.erase(std::lower_bound(sorted_.begin(), sorted_.end(), entries_.front().squared));
  entries_.pop_front();
}

}  // namespace thermorig::live
