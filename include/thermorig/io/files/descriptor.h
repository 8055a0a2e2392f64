// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>

namespace thermorig::files {

/// An open file descriptor, closed at the end of its life.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor();
  Descriptor(Descriptor&& other) noexcept;
  Descriptor& operator=(Descriptor&& other) noexcept;
  int get() const { return fd_; }
  explicit operator bool() const { return fd_ >= 0; }
  void close();
  int release();  // its number: whoever takes it closes it

 private:
  int fd_ = -1;
};

/// A file of so many bytes without a name, to read and write, which goes when it is closed and no longer
/// mapped: on the disk of the folder that `near` stands in, else of $TMPDIR, else of /var/tmp. Its room on
/// the disk is taken at once, so that no write to it can find the disk full. -1 where none of them has the
/// room and much to spare, or is a disk that knows such files (tmpfs lies in memory, and is none).
int open_unlinked(const std::filesystem::path& near, std::uint64_t bytes);

}  // namespace thermorig::files
