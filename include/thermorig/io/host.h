// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

namespace thermorig::io {

/// Operating system, release and machine, e.g. "Linux 6.1.0-18-amd64 x86_64".
std::string kernel_release();

/// Memory of this machine, bytes, or of the control groups that hold the program to less: whichever is least.
/// 0: not known.
std::uint64_t memory_bytes();

/// Processor time that the calling thread has used since it started, user and system, seconds.
double thread_cpu_s();

/// Signals are for other threads than the calling one, but those of its own faults, which must reach the
/// handler that stops the servo (emergency_bytes.h).
void take_no_signals();

/// Whether a file descriptor (0, 1, 2) is a terminal on which a line can be drawn over.
bool is_terminal(int descriptor);

}  // namespace thermorig::io
