// SPDX-License-Identifier: MIT
#pragma once

#include <csignal>
#include <ctime>

namespace thermorig::spill {

/// Calls a function on the thread that owns this, four times a millisecond, in the midst of whatever the
/// thread does: however busy the computer is, the thread gets no further than that without the call. Only
/// what POSIX calls async-signal-safe may be done there. System calls that the thread is in return EINTR
/// where SA_RESTART does not help.
class Interrupts {
 public:
  using Called = void (*)();

  Interrupts() = default;
  ~Interrupts();
  Interrupts(const Interrupts&) = delete;
  Interrupts& operator=(const Interrupts&) = delete;

  /// By the thread that owns this. False: the system has no timer to spare. `called` is the same for all.
  bool begin(Called called);
  /// By the thread that owns this, also from within the call.
  void end();

 private:
  bool make_timer(Called called);
  bool run(long period_ns);

  timer_t timer_{};
  bool is_made_ = false;
  volatile std::sig_atomic_t is_running_ = 0;
};

/// None on this thread meanwhile. Afterwards it takes them, even if it was told to take no signals.
class Uninterrupted {
 public:
  Uninterrupted();
  ~Uninterrupted();
  Uninterrupted(const Uninterrupted&) = delete;
  Uninterrupted& operator=(const Uninterrupted&) = delete;
};

}  // namespace thermorig::spill
