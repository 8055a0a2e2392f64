// SPDX-License-Identifier: MIT
#include "cage.h"

#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>

namespace thermorig::session {

namespace {

constexpr std::uint64_t memory_bytes = 1ULL << 30U;  // for any session, the program's own included ...
constexpr std::uint64_t memory_per_byte =
    24;  // ... and more for a large one: what was decoded of it, and its frames
constexpr std::uint64_t cpu_s = 2;
constexpr std::uint64_t bytes_per_cpu_s = 1U << 20U;  // a slow computer reads tens of these
constexpr std::uint64_t wall_per_cpu = 12;            // a machine may be busy with other things

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
// A sanitizer takes terabytes of addresses at the start, and asks by a pipe whether an object can be read.
constexpr bool is_sanitized = true;
#else
constexpr bool is_sanitized = false;
#endif

void limit(__rlimit_resource_t resource, std::uint64_t most) {
  const rlimit both{most, most};
  // Where a limit is refused because a lower one holds already, that one serves.
  ::setrlimit(resource, &both);
}

}  // namespace

void enter_cage(std::uint64_t session_bytes) {
  const std::uint64_t seconds = cpu_s + session_bytes / bytes_per_cpu_s;
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, 0);
  limit(RLIMIT_NPROC, 0);
  limit(RLIMIT_CPU, seconds);
  if (!is_sanitized) {
    limit(RLIMIT_NOFILE, 0);
    limit(RLIMIT_AS, memory_bytes + memory_per_byte * session_bytes);
  }
  ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  ::alarm(static_cast<unsigned>(std::min<std::uint64_t>(seconds * wall_per_cpu, 86'400)));
}

}  // namespace thermorig::session
