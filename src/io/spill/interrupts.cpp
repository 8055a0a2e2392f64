// SPDX-License-Identifier: MIT
#include "interrupts.h"

#include <unistd.h>

#include <cerrno>

namespace thermorig::spill {

namespace {

constexpr long period_ns = 250'000;

Interrupts::Called called_by_all = nullptr;

int its_signal() {
  return SIGRTMIN;
}

sigset_t only_its_signal() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, its_signal());
  return set;
}

void call(int /*signal*/) {
  const int error_number = errno;
  called_by_all();
  errno = error_number;
}

}  // namespace

Interrupts::~Interrupts() {
  if (is_made_) ::timer_delete(timer_);
  is_running_ = 0;  // one may still be on its way
}

bool Interrupts::begin(Called called) {
  if (!is_made_ && !make_timer(called)) return false;
  if (is_running_ == 0) is_running_ = run(period_ns) ? 1 : 0;
  return is_running_ != 0;
}

void Interrupts::end() {
  if (is_running_ != 0) run(0);
  is_running_ = 0;
}

bool Interrupts::make_timer(Called called) {
  called_by_all = called;
  struct sigaction action {};
  action.sa_handler = call;
  action.sa_flags = SA_RESTART | SA_ONSTACK;
  sigevent event{};
  event.sigev_notify = SIGEV_THREAD_ID;
  event.sigev_signo = its_signal();
  event._sigev_un._tid = ::gettid();  // glibc 2.36 has no other name for it
  is_made_ = ::sigaction(its_signal(), &action, nullptr) == 0 &&
             ::timer_create(CLOCK_MONOTONIC, &event, &timer_) == 0;
  return is_made_;
}

bool Interrupts::run(long every_ns) {
  const itimerspec times{.it_interval = {0, every_ns}, .it_value = {0, every_ns}};
  return ::timer_settime(timer_, 0, &times, nullptr) == 0;
}

Uninterrupted::Uninterrupted() {
  const sigset_t set = only_its_signal();
  ::pthread_sigmask(SIG_BLOCK, &set, nullptr);
}

Uninterrupted::~Uninterrupted() {
  const sigset_t set = only_its_signal();
  ::pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
}

}  // namespace thermorig::spill
