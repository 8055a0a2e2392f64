// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "thermorig/io/files/disk.h"

namespace thermorig::files {

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
