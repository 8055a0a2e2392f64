// SPDX-License-Identifier: MIT
#include "interrupts.h"

#include <atomic>
#include <csignal>

namespace thermorig::app {

namespace {

std::atomic<bool> seen{false};

sigset_t held_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals, signal);
  return signals;
}

}  // namespace

void watch_interrupts() {
  struct sigaction action {};
  action.sa_handler = [](int) { seen = true; };
  action.sa_flags = SA_RESETHAND;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() {
  return seen;
}

void hold_interrupts() {
  const sigset_t signals = held_signals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
}

void wait_for_interrupt() {
  const sigset_t signals = held_signals();
  int signal = 0;
  sigwait(&signals, &signal);
}

}  // namespace thermorig::app
