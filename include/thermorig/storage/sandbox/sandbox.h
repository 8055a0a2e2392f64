// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "thermorig/storage/sandbox/sealed_copy.h"

namespace thermorig::sandbox {

/// What a child does with a copy, as it is asked. The bytes that it returns go to the program; an Error means
/// that it refuses the copy, or what is asked of it, in the ordinary way.
using Task = std::string (*)(const SealedCopy& copy, std::string_view request);

inline constexpr std::size_t request_bytes_max = 512;
inline constexpr std::size_t usual_answer_bytes_max = 1U << 20U;

/// From here on ask() has a child process do one of these tasks, with limits on memory and time, no files and
/// no way out. To be called once, at the start of a program, while it has no second thread. Throws
/// Error(failed) if there can be no child.
void start(std::vector<Task> tasks);
bool is_started();

/// How a child's task ended; the first byte of what it answers.
enum class End : std::uint8_t {
  died = 0,  // no answer
  done = 1,
  refused = 2,      // in the ordinary way, and why
  no_cpu_time = 3,  // limits of the sandbox
  no_wall_time = 4,
  no_child = 5  // the computer has no room for a process: nothing was tried
};

struct Answer {
  End end = End::died;
  std::string bytes;  // whatever the file made of the child: not to be believed
};

/// A child does the task of that number, and is waited for. `request`: request_bytes_max at most; of the
/// answer no more than `bytes_max` are taken. May be called from several threads. Throws Error(failed) if
/// there can be no child.
Answer ask(const SealedCopy& copy, std::size_t task, std::string_view request = {},
           std::size_t bytes_max = usual_answer_bytes_max);

/// Passes an answer by that was given to the end. Throws what the child threw where it refused the copy,
/// which nobody else need read then; Error(not_a_session) for a copy that killed its reader ("damaged or
/// hostile"), Error(failed) for one that kept it busy for longer than any sound file of its size keeps a slow
/// computer
/// ("could not be read within ...").
void require_done(const Answer& answer, const SealedCopy& copy);

/// Counts data that were read: whoever reads much gets time for it. To be told by the task.
void count_inflated(std::uint64_t bytes);

}  // namespace thermorig::sandbox
