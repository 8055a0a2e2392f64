// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace thermorig::sandbox {

/// Processor time that a reader of a session of so many bytes gets before it has inflated anything, and
/// beyond which it is ended whatever it says; and time of the clock, on a machine that is busy with other
/// things. A byte may stand for a thousand that were the same: what is sound may take a slow computer long.
struct TimeLimits {
  std::uint64_t cpu_s = 0;
  std::uint64_t longest_cpu_s = 0;
  std::uint64_t wall_s = 0;
};
TimeLimits time_limits(std::uint64_t session_bytes);

/// For each so many bytes of data that it has read a reader gets a second more.
inline constexpr std::uint64_t inflated_bytes_per_cpu_s = 4U << 20U;  // a slow computer reads five times that

std::uint64_t inflated_bytes();  // that were counted; async-signal-safe

/// From here on this process can compute, and write to what it has open, and nothing else: the kernel refuses
/// it all other calls. It ends by a signal when it takes more memory or time than a sound session of so many
/// bytes needs, and leaves no core file. Where the kernel cannot filter calls (filter_calls()) it can open
/// and make nothing, and change nothing of a file, but it could still remove one, or signal another process.
/// The signals of time may be caught by who set that up before: SIGALRM, and SIGXCPU, which comes after
/// `cpu_s` and every second of processor time from then on.
void enter(std::uint64_t session_bytes);

/// From here on the limits on time end this process with an answer to the descriptor.
void answer_when_time_is_up(int answer);

}  // namespace thermorig::sandbox
