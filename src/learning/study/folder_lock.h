// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

namespace thermorig::study {

/// Makes a folder and keeps other programs from running a study in it, until this goes; the system lets go
/// also when the program is killed. Throws Error(no_permission) if another one does, Error(storage) if the
/// folder cannot be made.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_ = -1;
};

}  // namespace thermorig::study
