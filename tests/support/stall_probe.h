// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <thread>

namespace thermorig::tests {

constexpr double stall_s =
    0.08;  // a computer that keeps a byte for so long: a command is sent again (CommanderTimes)

/// Looks, for as long as it lives, at how long this machine keeps a byte that ought to be there at once:
/// every 10 ms a thread sends one through a pseudo terminal of its own. Time that the thread itself had to
/// wait for a processor counts, but where the system allows it the thread comes before all ordinary ones:
/// then programs that keep the processors busy, ours above all, are no excuse, and only a computer that stood
/// still is.
class StallProbe {
 public:
  StallProbe();
  ~StallProbe();
  StallProbe(const StallProbe&) = delete;
  StallProbe& operator=(const StallProbe&) = delete;

  /// Whether the system lets a thread come before the ordinary ones (CAP_SYS_NICE).
  static bool may_come_first();

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
