// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

namespace thermorig::rig {

/// An flock on a file or folder for as long as the object lives; the system drops it when the program dies.
class FileLock {
 public:
  enum class Wait { yes, no };

  /// Throws Error(storage) if `path` cannot be opened. With Wait::no, is_held() tells whether it was free.
  FileLock(const std::filesystem::path& path, Wait wait);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

  bool is_held() const { return held_; }

 private:
  int descriptor_ = -1;
  bool held_ = false;
};

}  // namespace thermorig::rig
