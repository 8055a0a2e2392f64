// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

#include "thermorig/io/files/disk.h"

namespace thermorig::sandbox {

/// What was read of a file, in memory, where nobody can change it any more: who looks at it twice sees the
/// same. Move-only; another process that is handed fd(), or what send_bytes() sends, sees the same bytes.
class SealedCopy {
 public:
  static constexpr std::int64_t bytes_max = 4LL << 30;  // no session is larger

  /// Throws Error: not_a_session if `path` is no regular file, cannot be opened or is larger than 4 GiB;
  /// storage if reading fails; failed if there is not enough memory.
  explicit SealedCopy(const std::filesystem::path& path);
  /// Of a descriptor that another process made, or of a socket that it sends the bytes to; takes it over.
  /// Throws Error: storage, failed.
  explicit SealedCopy(int fd, std::filesystem::path path);
  /// Of bytes that are in memory already. Throws Error: not_a_session if they are more than 4 GiB; failed.
  explicit SealedCopy(std::span<const std::byte> bytes, std::filesystem::path path);
  ~SealedCopy();
  SealedCopy(SealedCopy&& other) noexcept;
  SealedCopy(const SealedCopy&) = delete;

  /// None (-1) where the system makes no such file: it limits their size (`ulimit -f`), or their number.
  int fd() const { return fd_; }
  /// Sends size and bytes; false if the other side goes before it has them.
  bool send_bytes(int socket) const;
  std::span<const std::byte> bytes() const { return bytes_; }
  /// The name of the file that it is a copy of.
  const std::filesystem::path& path() const { return path_; }

 private:
  void map();

  std::filesystem::path path_;
  int fd_ = -1;
  std::span<const std::byte> bytes_;
};

/// SealedCopy of a file on any disk. Throws Error(not_a_session) if it cannot be read or is larger than 4
/// GiB.
SealedCopy copy_on(files::Disk& disk, const std::filesystem::path& path);

}  // namespace thermorig::sandbox
