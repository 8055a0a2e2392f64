// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "thermorig/core/time.h"
#include "thermorig/io/files/holder.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::rig {

/// Where one acquisition goes: `<output>/<environment>/<environment>_acq-<nn>_<UTC start>.h5`, the journal
/// beside it as `.journal`.
struct SessionFile {
  int acquisition = 0;  // from 1
  std::filesystem::path session;
  std::filesystem::path journal;
  std::vector<std::filesystem::path> made_folders;  // that were not there before, the innermost first
  std::int64_t clock_set_ns = 0;  // by so much the computer's wall clock was set during the recording
};

/// Throws Error(bad_usage) that says what is allowed unless `environment` is [a-z0-9-]{1,32}.
void check_environment(const std::string& environment);

/// Held while a number is chosen and its journal created, so that two recorders never take the same one.
class FolderLock {
 public:
  /// Creates `<output>/<environment>` if needed, to stay after a loss of power. Throws Error(storage) if that
  /// fails.
  FolderLock(const std::filesystem::path& output, const std::string& environment,
             files::Disk& disk = files::real_disk());
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  /// The next free number: one above the highest that any file of the folder carries, whatever its suffix.
  /// `utc_compact`: "20260725T143512Z". Throws Error(storage) if the folder cannot be read.
  SessionFile next(const std::string& utc_compact) const;

 private:
  void make_folders();

  files::Disk& disk_;
  std::filesystem::path folder_;
  std::string environment_;
  std::vector<std::filesystem::path> made_folders_;
  std::unique_ptr<files::FileLock> lock_;
};

/// The same acquisition with another start in its names: its journal is renamed. Where that is refused the
/// names stay.
SessionFile dated(const SessionFile& file, const std::string& utc_compact, files::Disk& disk);

/// "20260725T143512Z" from "2026-07-25T14:35:12.123456Z".
std::string compact_utc(const std::string& utc);

/// The session that a journal becomes: same name, `.h5`.
std::filesystem::path session_of(const std::filesystem::path& journal);

/// session::read_session() of a file on any disk.
session::Session stored_session(const std::filesystem::path& path, files::Disk& disk);

/// Removes a journal whose session holds every byte of it and is on the disk. Throws Error(storage).
void retire_journal(const std::filesystem::path& journal, files::Disk& disk);

}  // namespace thermorig::rig
