// SPDX-License-Identifier: MIT
#include "thermorig/io/host.h"

#include <pthread.h>
#include <sys/utsname.h>
#include <time.h>
#include <unistd.h>

#include <csignal>

namespace thermorig::io {

namespace {

utsname system_names() {
  utsname names{};
  uname(&names);
  return names;
}

}  // namespace

std::string host_name() {
  return system_names().nodename;
}

std::string kernel_release() {
  const utsname names = system_names();
  return std::string(names.sysname) + " " + names.release + " " + names.machine;
}

double thread_cpu_s() {
  timespec used{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
  return static_cast<double>(used.tv_sec) + static_cast<double>(used.tv_nsec) * 1e-9;
}

void take_no_signals() {
  sigset_t others;
  sigfillset(&others);
  for (const int own : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGSYS, SIGTRAP, SIGABRT}) sigdelset(&others, own);
  pthread_sigmask(SIG_SETMASK, &others, nullptr);
}

bool is_terminal(int descriptor) {
  return isatty(descriptor) == 1;
}

}  // namespace thermorig::io
