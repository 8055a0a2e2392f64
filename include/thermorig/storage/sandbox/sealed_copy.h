// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>

#include "thermorig/io/files/disk.h"

namespace thermorig::sandbox {

/// What was read of a file, where nobody can change it any more: who looks at it twice sees the same. A small
/// one is in memory. A large one is a file without a name on a disk near the original, if one has the room,
/// which nobody has open to write once it is made. Move-only; another process that is handed fd(), or what
/// send_bytes() sends, sees the same bytes.
class SealedCopy {
 public:
  static constexpr std::int64_t bytes_max = 4LL << 30;  // no session is larger
  static constexpr std::uint64_t small_bytes_max = 32U << 20U;

  /// Fills `out` with what stands from the offset on. Throws Error if it cannot.
  using ReadAt = std::function<void(std::uint64_t offset, std::span<std::byte> out)>;

  /// Throws Error: not_a_session if `path` is no regular file, cannot be opened or is larger than 4 GiB;
  /// no_permission if this user may not read it; storage if reading fails; failed if there is not enough
  /// memory.
  explicit SealedCopy(const std::filesystem::path& path);
  /// Of a descriptor that another process made, or of a socket that it sends the bytes to; takes it over.
  /// Throws Error: storage, failed.
  explicit SealedCopy(int fd, std::filesystem::path path);
  /// Of bytes that are in memory already. Throws Error: not_a_session if they are more than 4 GiB; failed.
  explicit SealedCopy(std::span<const std::byte> bytes, std::filesystem::path path);
  /// Of `size` bytes that are read in order, a small copy's at once. Throws Error as that does, and as
  /// `read_at` does.
  explicit SealedCopy(std::uint64_t size, const ReadAt& read_at, std::filesystem::path path);
  ~SealedCopy();
  SealedCopy(SealedCopy&& other) noexcept;
  SealedCopy(const SealedCopy&) = delete;

  /// None (-1) where the system makes no such file: it limits their size (`ulimit -f`), or their number.
  int fd() const { return fd_; }
  /// Sends size and bytes; false if the other side goes before it has them.
  bool send_bytes(int socket) const;
  std::span<const std::byte> bytes() const { return bytes_; }
  /// Says that what was looked at is not needed soon: it need not stay in memory where it is on a disk.
  void forget_pages() const noexcept;
  /// The name of the file that it is a copy of.
  const std::filesystem::path& path() const { return path_; }

 private:
  void map();
  void map_or_close();

  std::filesystem::path path_;
  int fd_ = -1;
  std::span<const std::byte> bytes_;
};

/// SealedCopy of a file on any disk. Throws Error(not_a_session) if it cannot be read or is larger than 4
/// GiB.
SealedCopy copy_on(files::Disk& disk, const std::filesystem::path& path);

}  // namespace thermorig::sandbox
