// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <thread>

namespace thermorig::tests {

constexpr double stall_s =
    0.08;  // a computer that keeps a byte for so long: a command is sent again (CommanderTimes)
constexpr int runs_max = 4;                             // of a test, as long as they are void
constexpr const char* no_second_try = "NO SECOND TRY";  // what tests/wall_clock.sh looks for

/// Looks, for as long as it lives, at how long this machine keeps a byte that ought to be there at once:
/// every 10 ms a thread sends one through a pseudo terminal of its own. Time that the thread itself had to
/// wait for a processor counts.
class StallProbe {
 public:
  StallProbe();
  ~StallProbe();
  StallProbe(const StallProbe&) = delete;
  StallProbe& operator=(const StallProbe&) = delete;

  /// The longest so far, in s.
  double worst_s() const { return worst_s_; }

 private:
  void watch();

  std::atomic<bool> stopping_ = false;
  std::atomic<double> worst_s_ = 0.0;
  std::thread thread_;
};

/// Returns once the machine let nothing wait for `limit_s` over 2 s, or after 120 s.
void wait_for_a_quiet_machine(double limit_s);

}  // namespace thermorig::tests
