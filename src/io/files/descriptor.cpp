// SPDX-License-Identifier: MIT
#include "thermorig/io/files/descriptor.h"

#include <fcntl.h>
#include <linux/magic.h>
#include <sys/resource.h>
#include <sys/statfs.h>
#include <unistd.h>

#include <cstdlib>
#include <utility>

#include "thermorig/io/files/disk.h"

namespace thermorig::files {

Descriptor::~Descriptor() {
  close();
}

Descriptor::Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  std::swap(fd_, other.fd_);
  return *this;
}

void Descriptor::close() {
  if (fd_ >= 0) ::close(release());
}

int Descriptor::release() {
  return std::exchange(fd_, -1);
}

namespace {

constexpr std::uint64_t spared_bytes = 256U << 20U;  // for what others write

/// A write beyond `ulimit -f` would end the program.
bool may_be_written(std::uint64_t bytes) {
  rlimit limit{};
  return ::getrlimit(RLIMIT_FSIZE, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY || bytes <= limit.rlim_cur;
}

bool takes_room(int file, std::uint64_t bytes) {
  struct statfs disk {};
  if (::fstatfs(file, &disk) != 0) return false;
  if (disk.f_type == TMPFS_MAGIC || disk.f_type == RAMFS_MAGIC) return false;
  const auto free_bytes =
      static_cast<std::uint64_t>(disk.f_bavail) * static_cast<std::uint64_t>(disk.f_bsize);
  return free_bytes >= bytes && free_bytes - bytes >= spared_bytes &&
         ::fallocate(file, 0, 0, static_cast<off_t>(bytes)) == 0;
}

int open_in(const std::filesystem::path& folder, std::uint64_t bytes) {
  const int file = ::open(folder.c_str(), O_TMPFILE | O_EXCL | O_RDWR | O_CLOEXEC, 0600);
  if (file < 0 || takes_room(file, bytes)) return file;
  ::close(file);
  return -1;
}

}  // namespace

int open_unlinked(const std::filesystem::path& near, std::uint64_t bytes) {
  if (bytes == 0 || !may_be_written(bytes)) return -1;
  int file = open_in(folder_of(near), bytes);
  if (const char* folder = std::getenv("TMPDIR"); file < 0 && folder != nullptr)
    file = open_in(folder, bytes);
  return file < 0 ? open_in("/var/tmp", bytes) : file;
}

}  // namespace thermorig::files
