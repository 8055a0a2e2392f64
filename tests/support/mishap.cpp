// SPDX-License-Identifier: MIT
// Preloaded into the program under test: after SIGUSR1 the next read() of a port does what $THERMORIG_MISHAP
// names.
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <stdexcept>

namespace {

volatile std::sig_atomic_t struck = 0;
volatile bool memory_gone = false;

void strike(int) {
  struck = 1;
}

__attribute__((constructor)) void listen() {
  struct sigaction action {};
  action.sa_handler = strike;
  action.sa_flags = SA_RESTART;
  if (std::getenv("THERMORIG_MISHAP") != nullptr) sigaction(SIGUSR1, &action, nullptr);
}

__attribute__((noinline)) int overflow(int depth) {  // NOLINT: that is what it is for
  volatile char frame[4096];
  frame[0] = static_cast<char>(depth);
  return overflow(depth + 1) + frame[0];
}

void suffer() {
  const char* mishap = std::getenv("THERMORIG_MISHAP");
  struck = 0;
  if (std::strcmp(mishap, "ExceptionThrown") == 0) throw std::runtime_error("an exception out of nowhere");
  if (std::strcmp(mishap, "TerminateCalled") == 0) std::terminate();
  if (std::strcmp(mishap, "NullDereferenced") == 0) *static_cast<volatile int*>(nullptr) = 1;
  if (std::strcmp(mishap, "StackOverflown") == 0) overflow(0);
  if (std::strcmp(mishap, "MemoryGone") == 0) memory_gone = true;
}

}  // namespace

extern "C" {

ssize_t read(int file, void* buffer, std::size_t size) {
  if (struck != 0 && isatty(file) == 1) suffer();
  return syscall(SYS_read, file, buffer, size);
}

void* __libc_malloc(std::size_t size);

void* malloc(std::size_t size) {
  if (!memory_gone) return __libc_malloc(size);
  errno = ENOMEM;
  return nullptr;
}

}  // extern "C"
