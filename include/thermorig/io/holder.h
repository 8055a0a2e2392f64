// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace thermorig::io {

/// "process 4711 (thermorig)" for a process other than this one that holds `path` open, as far as this user
/// may look: processes of others stay hidden. None if there is none. `proc`: where the system tells of
/// processes.
std::optional<std::string> other_holder_of(const std::string& path,
                                           const std::filesystem::path& proc = "/proc");

/// The same, else "this process" if this one holds it, else "another program".
std::string holder_of(const std::string& path);

}  // namespace thermorig::io
