// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "thermorig/study/study.h"

namespace thermorig::study {

/// Writes a result under its job's name: to a temporary name, synced, renamed, and the folder synced, so that
/// it is there whole or not at all. Throws Error(storage).
void write_result(const std::filesystem::path& folder, const JobResult& result);

/// Throws Error(not_a_session) for a damaged file, Error(storage) for one that cannot be read.
JobResult read_result(const std::filesystem::path& path);

/// The job's result, if the folder has one. A file of that name which holds another job is damaged.
std::optional<JobResult> find_result(const std::filesystem::path& folder, const Job& job);

/// Keeps other programs from running a study in the same folder, until it goes. Throws Error(no_permission)
/// if one does, Error(storage) if the folder cannot be made.
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
