// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "thermorig/io/files/disk.h"

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

/// A lock on a file or folder for as long as the object lives; the system drops it when the program dies.
class FileLock {
 public:
  using Wait = Disk::Wait;

  /// Throws Error(storage) if `path` cannot be opened. With Wait::no, is_held() tells whether it was free.
  FileLock(const std::filesystem::path& path, Wait wait, Disk& disk);

  bool is_held() const { return held_; }
  /// False as well where the file system has no locks: then another may hold it, and nobody knows.
  bool is_certain() const { return certain_; }

 private:
  ClosedOnExit file_;
  bool held_ = false;
  bool certain_ = false;
};

}  // namespace thermorig::files
