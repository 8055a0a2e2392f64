// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace thermorig::files {

/// Which open files count: all, or those that can be written through.
enum class Use : std::uint8_t { any, writing };

/// "process 4711 (python3)" for a process other than this one that has the file or device `path` open, as far
/// as this user may look: processes of others stay hidden. None if there is none. `proc`: where the system
/// tells of processes.
std::optional<std::string> other_holder_of(const std::filesystem::path& path, Use use = Use::any,
                                           const std::filesystem::path& proc = "/proc");

/// The same, else "this process" if this one holds it, else "another program".
std::string holder_of(const std::filesystem::path& path);

}  // namespace thermorig::files
