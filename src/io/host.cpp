// SPDX-License-Identifier: MIT
#include "thermorig/io/host.h"

#include <pthread.h>
#include <sys/utsname.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <limits>

namespace thermorig::io {

namespace {

utsname system_names() {
  utsname names{};
  uname(&names);
  return names;
}

namespace fs = std::filesystem;

constexpr std::uint64_t no_limit = std::numeric_limits<std::uint64_t>::max();

/// "max" where the group has none.
std::uint64_t number_in(const fs::path& file) {
  std::uint64_t number = no_limit;
  std::ifstream text(file);
  return text >> number ? number : no_limit;
}

/// Of a control group and those that it lies in. In a container the file system shows the lowest of them as
/// the root, whatever the group's path says.
std::uint64_t group_limit(const fs::path& root, fs::path group, const char* file) {
  std::uint64_t least = no_limit;
  for (group = group.relative_path();; group = group.parent_path()) {
    least = std::min(least, number_in(root / group / file));
    if (group.empty()) return least;
  }
}

/// By /proc/self/cgroup, a line a hierarchy: "4:memory:/user.slice", and of version 2 "0::/user.slice".
std::uint64_t group_limits() {
  std::uint64_t least = no_limit;
  std::ifstream lines("/proc/self/cgroup");
  for (std::string line; std::getline(lines, line);) {
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1),
                      group = line.substr(second + 1);
    if (controllers.empty())
      least = std::min(least, group_limit("/sys/fs/cgroup", group, "memory.max"));
    else if (controllers == "memory")
      least = std::min(least, group_limit("/sys/fs/cgroup/memory", group, "memory.limit_in_bytes"));
  }
  return least;
}

}  // namespace

std::uint64_t memory_bytes() {
  const auto pages = static_cast<std::uint64_t>(std::max(0L, ::sysconf(_SC_PHYS_PAGES)));
  return std::min(pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)), group_limits());
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
