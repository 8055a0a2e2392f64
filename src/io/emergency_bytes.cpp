// SPDX-License-Identifier: MIT
#include "thermorig/io/emergency_bytes.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdlib>

namespace thermorig::io {

namespace {

constexpr std::size_t words_max = 16;
constexpr std::size_t stack_bytes = 1U << 16U;

/// Read by signal handlers: plain memory and lock-free flags only.
struct EmergencyBytes {
  std::atomic<int> fd{-1};
  std::array<std::uint8_t, words_max> bytes{};
  std::size_t size = 0;
};

/// All whose default ends a program and that can be caught, but for those that the loop takes for a request
/// to stop (INT, TERM, HUP), which are taken here only where nobody else does.
constexpr std::array signals{SIGSEGV, SIGBUS,    SIGFPE,  SIGILL,  SIGABRT, SIGSYS,   SIGTRAP, SIGQUIT,
                             SIGINT,  SIGTERM,   SIGHUP,  SIGPIPE, SIGALRM, SIGUSR1,  SIGUSR2, SIGXCPU,
                             SIGXFSZ, SIGVTALRM, SIGPROF, SIGIO,   SIGPWR,  SIGSTKFLT};

std::array<EmergencyBytes, 4> kept_words;
std::array<struct sigaction, signals.size()> before;
alignas(std::max_align_t) std::array<std::byte, stack_bytes> stack;  // the usual one may be what overflowed
static_assert(std::atomic<int>::is_always_lock_free);

/// Says them, puts the signal back to what it did before, and has it come again when the handler returns.
void on_signal(int signal) {
  const int error = errno;
  send_emergency_bytes();
  const auto* at = std::find(signals.begin(), signals.end(), signal);
  ::sigaction(signal, &before[static_cast<std::size_t>(at - signals.begin())], nullptr);
  ::raise(signal);
  errno = error;
}

bool ends_the_program(const struct sigaction& action) {
  return (action.sa_flags & SA_SIGINFO) == 0 && action.sa_handler == SIG_DFL;
}

bool is_of_a_sanitizer(int signal, const struct sigaction& action) {
  const bool fault = signal == SIGSEGV || signal == SIGBUS || signal == SIGFPE || signal == SIGILL;
  return fault && (action.sa_flags & SA_SIGINFO) != 0;
}

void catch_signals() {
  const stack_t alternate{.ss_sp = stack.data(), .ss_flags = 0, .ss_size = stack.size()};
  ::sigaltstack(&alternate, nullptr);
  for (std::size_t i = 0; i < signals.size(); ++i) {
    ::sigaction(signals[i], nullptr, &before[i]);
    if (!ends_the_program(before[i]) && !is_of_a_sanitizer(signals[i], before[i])) continue;
    struct sigaction action {};
    action.sa_handler = on_signal;
    action.sa_flags = SA_ONSTACK;
    ::sigaction(signals[i], &action, nullptr);
  }
}

void prepare_once() {
  static const bool prepared = [] {
    catch_signals();
    return std::atexit([] { send_emergency_bytes(); }) == 0;
  }();
  (void)prepared;
}

}  // namespace

void keep_emergency_bytes(int fd, std::span<const std::uint8_t> bytes) {
  assert(fd >= 0 && bytes.size() <= words_max);
  prepare_once();
  forget_emergency_bytes(fd);
  for (EmergencyBytes& port : kept_words) {
    if (port.fd >= 0) continue;
    std::copy(bytes.begin(), bytes.end(), port.bytes.begin());
    port.size = bytes.size();
    std::atomic_signal_fence(std::memory_order_seq_cst);
    port.fd = fd;
    return;
  }
  assert(false && "more ports than there are places for their bytes");
}

void forget_emergency_bytes(int fd) {
  for (EmergencyBytes& port : kept_words)
    if (port.fd == fd) port.fd = -1;
}

void send_emergency_bytes() {
  for (const EmergencyBytes& port : kept_words) {
    const int fd = port.fd;
    if (fd < 0) continue;
    for (int tries = 0; tries < 3; ++tries) {
      if (::write(fd, port.bytes.data(), port.size) >= 0 || errno != EINTR) break;
    }
  }
}

}  // namespace thermorig::io
