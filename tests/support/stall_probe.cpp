// SPDX-License-Identifier: MIT
#include "stall_probe.h"

#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>

#include "thermorig/io/port.h"

namespace thermorig::tests {

namespace {

using Clock = std::chrono::steady_clock;
constexpr auto period = std::chrono::milliseconds(10);
constexpr auto look = std::chrono::seconds(2);
constexpr auto patience = std::chrono::seconds(120);
constexpr int answer_ms = 1000;

/// The program's side of a pseudo terminal, raw.
class Reader {
 public:
  explicit Reader(const std::string& path) : fd_(open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK)) {
    termios settings{};
    tcgetattr(fd_, &settings);
    cfmakeraw(&settings);
    tcsetattr(fd_, TCSANOW, &settings);
  }
  ~Reader() { close(fd_); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  void wait_for_a_byte() const {
    pollfd waiting{.fd = fd_, .events = POLLIN, .revents = 0};
    poll(&waiting, 1, answer_ms);
    std::uint8_t bytes[16];
    while (read(fd_, bytes, sizeof bytes) > 0) {
    }
  }

 private:
  int fd_;
};

bool come_first(int policy) {
  const sched_param parameters{.sched_priority = sched_get_priority_min(policy)};
  return pthread_setschedparam(pthread_self(), policy, &parameters) == 0;
}

}  // namespace

bool StallProbe::may_come_first() {
  bool may = false;
  std::thread([&may] { may = come_first(SCHED_FIFO); }).join();
  return may;
}

StallProbe::StallProbe() : thread_([this] { watch(); }) {}

StallProbe::~StallProbe() {
  stopping_ = true;
  thread_.join();
}

void StallProbe::watch() {
  io::Pty pty;
  const Reader reader(pty.path());
  pty.is_open();
  come_first(SCHED_FIFO);  // where it may not, it waits its turn, and what it waits counts
  const std::uint8_t byte = 0;
  for (auto due = Clock::now(); !stopping_; due = std::max(due + period, Clock::now())) {
    std::this_thread::sleep_until(due);
    pty.write({&byte, 1});
    reader.wait_for_a_byte();
    worst_s_ = std::max<double>(worst_s_, std::chrono::duration<double>(Clock::now() - due).count());
  }
}

void wait_for_a_quiet_machine(double limit_s) {
  for (const auto until = Clock::now() + patience; Clock::now() < until;) {
    const StallProbe probe;
    std::this_thread::sleep_for(look);
    if (probe.worst_s() < limit_s) return;
  }
}

}  // namespace thermorig::tests
