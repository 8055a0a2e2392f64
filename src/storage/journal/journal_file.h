// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <span>

#include "thermorig/io/files/disk.h"

namespace thermorig::journal {

/// The file under a journal: creates, reserves, appends, syncs. Every refusal of the disk is Error(storage).
/// After a write or a sync that failed nothing is written any more: what was not synced before may be lost,
/// even if a later sync succeeds.
class JournalFile {
 public:
  JournalFile(std::filesystem::path path, std::uint64_t reserve_bytes, files::Disk& disk);
  ~JournalFile();
  JournalFile(const JournalFile&) = delete;
  JournalFile& operator=(const JournalFile&) = delete;

  /// All parts, or Error(storage); a record that did not fit is taken back.
  void append(std::span<const std::span<const std::byte>> parts);
  void sync();
  void sync_folder();

  /// Reserves up to `bytes` from the file's front. False if the disk has no room for them.
  bool reserve(std::uint64_t bytes);
  std::uint64_t reserved() const { return reserved_; }
  /// False: the file system cannot, and reserved() is only what is expected.
  bool can_reserve() const { return can_reserve_; }
  std::uint64_t free_bytes() const;  // of the disk, beside the reserve; UINT64_MAX: unknown

  /// Gives the unused reserve back, syncs and closes.
  void close();
  /// Closes and removes it: nothing is in it yet.
  void abandon();

  std::uint64_t size() const { return size_; }

 private:
  void reserve_or_refuse(std::uint64_t bytes);
  void require_sound() const;
  void note_failure(const char* action, int error_number);
  [[noreturn]] void fail(const char* action, int error_number);
  [[noreturn]] void refuse(const char* action, int error_number) const;

  files::Disk& disk_;
  std::filesystem::path path_;
  files::OpenFile file_ = files::OpenFile::none;
  std::uint64_t size_ = 0;
  std::uint64_t reserved_ = 0;
  bool can_reserve_ = true;
  std::mutex failure_turn_;  // syncs come from another thread
  std::atomic<bool> failed_ = false;
  struct Failure {
    const char* action = "";
    int error_number = 0;
  } failure_;  // the first; written before `failed_`
};

}  // namespace thermorig::journal
