// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

namespace thermorig::journal {

/// The file under a journal: creates, reserves, appends, syncs. Every refusal of the system is
/// Error(storage).
class JournalFile {
 public:
  JournalFile(std::filesystem::path path, std::uint64_t reserve_bytes);
  ~JournalFile();
  JournalFile(const JournalFile&) = delete;
  JournalFile& operator=(const JournalFile&) = delete;

  /// All parts with one writev(), or Error(storage); a record that did not fit is taken back.
  void append(std::span<const std::span<const std::uint8_t>> parts);
  void sync();
  void sync_folder();

  /// Gives the unused reserve back, syncs and closes.
  void close();

  std::uint64_t size() const { return size_; }
  const std::filesystem::path& path() const { return path_; }

 private:
  void reserve(std::uint64_t bytes);
  [[noreturn]] void refuse(const char* action, int error_number) const;

  std::filesystem::path path_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
  bool failed_ = false;
};

}  // namespace thermorig::journal
