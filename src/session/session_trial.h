// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "thermorig/session/sealed_copy.h"

namespace thermorig::session {

/// Everything that reading the copy asks of libhdf5 and of this program, for nothing: throws as
/// read_session() does.
void read_for_nothing(const SealedCopy& copy);

/// What altered_attributes() looks for, in this process.
std::vector<std::string> altered_in(const SealedCopy& copy);

/// How a child's reading ended; what it answers.
enum class TrialEnd : std::uint8_t {
  died = 0,  // no answer
  read = 1,
  refused = 2,      // in the ordinary way: the program will say why
  no_cpu_time = 3,  // limits of the cage
  no_wall_time = 4,
  no_child = 5  // the computer has no room for a process: nothing was tried
};

/// From here on the limits of the cage on time end this process with an answer to the descriptor.
void answer_when_time_is_up(int answer);

/// Passes a copy by that its reader may have, or may refuse in the ordinary way. Throws as tried_copy() does.
void require_harmless(TrialEnd end, const SealedCopy& copy);

/// Whether whoever opens this copy as a session gets one: as a program does that reads a stranger's file, a
/// child process first. Throws as tried_copy() and read_session() do.
void require_readable(SealedCopy copy);

}  // namespace thermorig::session
