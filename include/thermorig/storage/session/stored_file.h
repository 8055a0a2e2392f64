// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include "thermorig/io/files/disk.h"

namespace thermorig::session {

/// Throws Error(not_a_session): `what` is wrong with the file, and what to try.
[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& what);

/// The file of a session, opened once: whatever takes its name later, who reads this reads the same file. It
/// is closed with the last copy of this.
class StoredFile {
 public:
  static constexpr std::uint64_t bytes_max = 4ULL << 30U;  // no session is larger

  /// Fills `out` with what stands from the offset on. Throws Error if it cannot.
  using ReadAt = std::function<void(std::uint64_t offset, std::span<std::byte> out)>;

  /// Throws Error: not_a_session if `path` is no regular file, cannot be opened or is larger than 4 GiB;
  /// no_permission if this user may not read it.
  explicit StoredFile(const std::filesystem::path& path);
  /// On any disk, which must outlive this. Throws Error(not_a_session) if it cannot be opened or is larger.
  StoredFile(files::Disk& disk, const std::filesystem::path& path);
  /// Of `size` bytes. Throws Error(not_a_session) if that is larger.
  StoredFile(std::uint64_t size, ReadAt read_at, std::filesystem::path path);

  /// The name that it was opened under.
  const std::filesystem::path& path() const { return path_; }
  std::uint64_t size() const { return size_; }
  /// Zeros behind the end. May be called from several threads. Throws Error: storage, or not_a_session.
  void read(std::uint64_t offset, std::span<std::byte> out) const;
  /// Where it ends by its own word, as format version 0 of HDF5's superblock has it, which is what thermorig
  /// writes; 0: of other versions, and of what is no HDF5. Throws as read() does.
  std::uint64_t stated_end() const;

 private:
  std::filesystem::path path_;
  std::uint64_t size_ = 0;
  ReadAt read_at_;
};

}  // namespace thermorig::session
