// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <thread>

namespace thermorig::tests {

/// Waits for what another thread or program does. The time is for machines that stand still: no test measures
/// by it.
inline bool comes_true(const std::function<bool()>& condition) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

/// A clock that stands unless it is moved by hand. Any thread may look at it.
class HandClock {
 public:
  using Time = std::chrono::steady_clock::time_point;

  Time now() const { return Time(std::chrono::hours(1) + std::chrono::nanoseconds(passed_ns_)); }
  void advance(std::chrono::nanoseconds time) { passed_ns_ += time.count(); }

  /// Moves on in steps until the condition holds. Who looks at the clock now and then only may miss many
  /// steps: this shows that something comes, not when.
  bool advance_until(const std::function<bool()>& condition, std::chrono::nanoseconds step) {
    return comes_true([&] {
      if (condition()) return true;
      advance(step);
      return false;
    });
  }

 private:
  std::atomic<std::chrono::nanoseconds::rep> passed_ns_ = 0;
};

}  // namespace thermorig::tests
