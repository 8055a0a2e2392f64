// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace thermorig::files {

/// A process, told apart from every other one on the machines that share a disk.
struct Process {
  std::string host;         // name of its machine: letters, digits, '-', '_' and '.', at most 64
  std::string boot;         // that machine's own number of its last start; the same characters
  std::uint64_t space = 0;  // in which its number counts: a container has one of its own
  std::uint64_t number = 0;
  std::uint64_t start = 0;  // clock ticks after the machine's start
  auto operator<=>(const Process&) const = default;
};

/// "node7, process 4711".
std::string text_of(const Process& process);

/// The calling one. `proc`: where the system tells of processes; what it does not tell is empty or 0.
Process this_process(const std::filesystem::path& proc = "/proc");

/// Of a process that is not of this machine, since its last start, or counts in another space, nothing is
/// known.
enum class Life : std::uint8_t { unknown, runs, ended };
Life life_of(const Process& process, const std::filesystem::path& proc = "/proc");

/// Is it known to have ended?
bool has_ended(const Process& process, const std::filesystem::path& proc = "/proc");

/// Is there no process of that number on this machine, as far as the calling one's space goes?
bool is_unused(std::uint64_t number);

}  // namespace thermorig::files
