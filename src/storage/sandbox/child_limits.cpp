// SPDX-License-Identifier: MIT
#include "child_limits.h"

#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>

#include "call_filter.h"
#include "sanitized.h"
#include "thermorig/storage/sandbox/sandbox.h"

namespace thermorig::sandbox {

namespace {

constexpr std::uint64_t memory_bytes = 1ULL << 30U;  // for any session, the program's own included ...
constexpr std::uint64_t memory_per_byte =
    24;  // ... and more for a large one: what was decoded of it, and its frames
constexpr std::uint64_t least_cpu_s = 3;
constexpr std::uint64_t bytes_per_cpu_s = 1U << 20U;  // a slow computer reads tens of these
constexpr std::uint64_t inflated_per_byte = 1032;     // at most: deflate
constexpr std::uint64_t wall_per_cpu = 12;            // a machine may be busy with other things
constexpr std::uint64_t longest_wall_s = 86'400;

std::atomic<std::uint64_t> inflated = 0;
static_assert(std::atomic<std::uint64_t>::is_always_lock_free);

void limit(__rlimit_resource_t resource, std::uint64_t most, std::uint64_t beyond = 0) {
  const rlimit soft_and_hard{most, most + beyond};
  // Where a limit is refused because a lower one holds already, that one serves.
  ::setrlimit(resource, &soft_and_hard);
}

}  // namespace

TimeLimits time_limits(std::uint64_t session_bytes) {
  const std::uint64_t cpu_s = least_cpu_s + session_bytes / bytes_per_cpu_s;
  const std::uint64_t longest_s = cpu_s + 1 + inflated_per_byte * session_bytes / inflated_bytes_per_cpu_s;
  return {.cpu_s = cpu_s,
          .longest_cpu_s = longest_s,
          .wall_s = std::min(longest_s * wall_per_cpu, longest_wall_s)};
}

void count_inflated(std::uint64_t bytes) {
  inflated.fetch_add(bytes, std::memory_order_relaxed);
}

std::uint64_t inflated_bytes() {
  return inflated.load(std::memory_order_relaxed);
}

void enter(std::uint64_t session_bytes) {
  const TimeLimits time = time_limits(session_bytes);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, 0);
  limit(RLIMIT_NPROC, 0);
  limit(RLIMIT_CPU, time.cpu_s, time.longest_cpu_s - time.cpu_s);
  if (!is_sanitized) {
    limit(RLIMIT_NOFILE, 0);
    limit(RLIMIT_AS, memory_bytes + memory_per_byte * session_bytes);
  }
  ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  ::alarm(static_cast<unsigned>(time.wall_s));
  filter_calls();
}

}  // namespace thermorig::sandbox
