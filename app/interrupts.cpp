// SPDX-License-Identifier: MIT
#include "interrupts.h"

#include <atomic>
#include <csignal>

namespace thermorig::app {

namespace {

std::atomic<bool> seen{false};

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

}  // namespace thermorig::app
