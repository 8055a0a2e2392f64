// SPDX-License-Identifier: MIT
#include "thermorig/storage/sandbox/sealed_copy.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "thermorig/core/error.h"
#include "thermorig/core/git_lfs.h"
#include "thermorig/core/printable.h"
#include "thermorig/io/files/descriptor.h"
#include "thermorig/io/files/unlinked_file.h"
#include "thermorig/storage/sandbox/refusal.h"

namespace thermorig::sandbox {

namespace {

namespace fs = std::filesystem;
using files::Descriptor;

constexpr std::size_t part_bytes = 1U << 20U;  // of a large copy, at a time

[[noreturn]] void no_memory(const fs::path& path) {
  throw Error(ExitCode::failed, std::string("no copy of it could be made in memory: ") + std::strerror(errno),
              path.string(), "close other programs");
}

[[noreturn]] void cannot_open(const fs::path& path, int error_number) {
  const std::string what = std::string("cannot be opened: ") + std::strerror(error_number);
  if (error_number != EACCES && error_number != EPERM) refuse(path, what);
  throw Error(ExitCode::no_permission, what, path.string(),
              "see who may read it: ls -l " + shell_word(path.string()));
}

[[noreturn]] void too_large(const fs::path& path) {
  refuse(path, "is larger than any session: 4 GiB");
}

/// The pointers that stand for sessions in a clone without git-lfs have fewer bytes than this (their
/// specification), and no session has so few.
void refuse_git_lfs_pointer(const Descriptor& file, std::int64_t size, const fs::path& path) {
  std::array<char, 1024> head{};
  if (size > static_cast<std::int64_t>(head.size())) return;
  const ssize_t count = ::pread(file.get(), head.data(), head.size(), 0);
  if (count > 0 && is_git_lfs_pointer({head.data(), static_cast<std::size_t>(count)}))
    throw Error(ExitCode::not_a_session, "is a Git LFS pointer: the file itself was not fetched",
                path.string(), git_lfs_advice);
}

/// Looked at before it is opened: opening a pipe waits, and opening a port moves its lines.
Descriptor open_regular(const fs::path& path, std::int64_t& size) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) cannot_open(path, errno);
  if (S_ISDIR(info.st_mode))
    throw Error(ExitCode::not_a_session, "this is a folder, not a session", path.string(),
                "name the session files (.h5) in it, or below it");
  if (!S_ISREG(info.st_mode)) refuse(path, "is not a regular file");
  Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
  if (!file) cannot_open(path, errno);
  if (::fstat(file.get(), &info) != 0 || !S_ISREG(info.st_mode)) refuse(path, "is not a regular file");
  if (info.st_size > SealedCopy::bytes_max) too_large(path);
  size = info.st_size;
  refuse_git_lfs_pointer(file, size, path);
  return file;
}

/// A limit of the shell on the size of files (`ulimit -f`) counts for files in memory as well, although they
/// take nothing of any disk: it shall keep nobody from reading.
bool may_be_a_file(std::int64_t size) {
  rlimit limit{};
  return ::getrlimit(RLIMIT_FSIZE, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY ||
         static_cast<rlim_t>(size) <= limit.rlim_cur;
}

[[noreturn]] void unreadable(const fs::path& path, const char* why) {
  throw Error(ExitCode::storage, std::string("cannot be read: ") + why, path.string(),
              "check the disk (dmesg), and copy the file to another one");
}

[[noreturn]] void unreadable_on_disk(const fs::path& path, int error_number) {
  throw Error(ExitCode::not_a_session, std::string("cannot be read: ") + std::strerror(error_number),
              path.string(), "check the disk (dmesg)");
}

void fill(int from, std::span<std::byte> out, const fs::path& path) {
  while (!out.empty()) {
    const ssize_t size = ::read(from, out.data(), out.size());
    if (size < 0 && errno == EINTR) continue;
    if (size < 0) unreadable(path, std::strerror(errno));
    if (size == 0) unreadable(path, "it became shorter meanwhile");
    out = out.subspan(static_cast<std::size_t>(size));
  }
}

/// `size` bytes in memory of this process alone, which `fill_in` writes once.
template <typename FillIn>
std::span<const std::byte> private_copy(std::size_t size, const fs::path& path, FillIn fill_in) {
  if (size == 0) return {};
  void* const at =
      ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (at == MAP_FAILED) no_memory(path);
  const std::span bytes(static_cast<std::byte*>(at), size);
  try {
    fill_in(bytes);
  } catch (const Error&) {
    ::munmap(at, size);
    throw;
  }
  ::mprotect(at, size, PROT_READ);
  return bytes;
}

std::span<const std::byte> copy_of_next(int from, std::size_t size, const fs::path& path) {
  return private_copy(size, path, [&](std::span<std::byte> out) { fill(from, out, path); });
}

/// What send_bytes() sends.
std::span<const std::byte> received_copy(int socket, const fs::path& path) {
  std::uint64_t size = 0;
  fill(socket, std::as_writable_bytes(std::span(&size, 1)), path);
  return copy_of_next(socket, size, path);
}

bool send_all(int socket, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t size = ::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(size));
  }
  return true;
}

void write_all(int fd, const char* bytes, std::size_t size, const fs::path& path) {
  while (size > 0) {
    const ssize_t written = ::write(fd, bytes, size);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) no_memory(path);
    bytes += written;
    size -= static_cast<std::size_t>(written);
  }
}

void copy(int from, int to, const fs::path& path) {
  std::array<char, 1U << 16U> buffer;
  for (std::int64_t all = 0; all <= SealedCopy::bytes_max;) {
    const ssize_t size = ::read(from, buffer.data(), buffer.size());
    if (size < 0 && errno == EINTR) continue;
    if (size < 0) unreadable(path, std::strerror(errno));
    if (size == 0) return;
    write_all(to, buffer.data(), static_cast<std::size_t>(size), path);
    all += size;
  }
  too_large(path);
}

/// A file without a name, of a large copy.
class DiskCopy {
 public:
  DiskCopy(const fs::path& near, std::uint64_t size)
      : file_(size > SealedCopy::small_bytes_max ? files::open_unlinked(near, size) : -1),
        to_read_(!file_ ? -1
                        : ::open(("/proc/self/fd/" + std::to_string(file_.get())).c_str(),
                                 O_RDONLY | O_CLOEXEC)) {}

  bool is_possible() const { return static_cast<bool>(to_read_); }
  int to_write() const { return file_.get(); }

  /// As long as what was written, and a descriptor that nobody can write to: the other one goes with this.
  int seal(const fs::path& path) {
    const off_t size = ::lseek(file_.get(), 0, SEEK_CUR);
    if (size < 0 || ::ftruncate(file_.get(), size) != 0) no_memory(path);
    return to_read_.release();
  }

 private:
  Descriptor file_;
  Descriptor to_read_;
};

}  // namespace

SealedCopy::SealedCopy(const fs::path& path) : path_(path) {
  std::int64_t size = 0;
  const Descriptor file = open_regular(path, size);
  if (DiskCopy on_disk(path, static_cast<std::uint64_t>(size)); on_disk.is_possible()) {
    copy(file.get(), on_disk.to_write(), path);
    fd_ = on_disk.seal(path);
    map_or_close();
    return;
  }
  Descriptor memory(may_be_a_file(size) ? ::memfd_create("session", MFD_CLOEXEC | MFD_ALLOW_SEALING) : -1);
  if (!memory) {
    bytes_ = copy_of_next(file.get(), static_cast<std::size_t>(size), path);
    return;
  }
  copy(file.get(), memory.get(), path);
  if (::fcntl(memory.get(), F_ADD_SEALS, F_SEAL_SEAL | F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE) != 0)
    no_memory(path);
  fd_ = memory.release();
  map_or_close();
}

SealedCopy::SealedCopy(int fd, fs::path path) : path_(std::move(path)) {
  Descriptor memory(fd);
  struct stat info {};
  if (::fstat(fd, &info) == 0 && S_ISSOCK(info.st_mode)) {
    bytes_ = received_copy(fd, path_);
    return;
  }
  fd_ = fd;
  map();
  memory.release();
}

SealedCopy::SealedCopy(std::span<const std::byte> bytes, fs::path path) : path_(std::move(path)) {
  if (bytes.size() > static_cast<std::size_t>(bytes_max)) too_large(path_);
  bytes_ = private_copy(bytes.size(), path_,
                        [&](std::span<std::byte> out) { std::ranges::copy(bytes, out.begin()); });
}

SealedCopy::SealedCopy(std::uint64_t size, const ReadAt& read_at, fs::path path) : path_(std::move(path)) {
  if (size > static_cast<std::uint64_t>(bytes_max)) too_large(path_);
  DiskCopy on_disk(path_, size);
  if (!on_disk.is_possible()) {
    bytes_ = private_copy(size, path_, [&](std::span<std::byte> out) { read_at(0, out); });
    return;
  }
  std::vector<std::byte> part(part_bytes);
  for (std::uint64_t offset = 0; offset < size; offset += part.size()) {
    part.resize(std::min<std::uint64_t>(part_bytes, size - offset));
    read_at(offset, part);
    write_all(on_disk.to_write(), reinterpret_cast<const char*>(part.data()), part.size(), path_);
  }
  fd_ = on_disk.seal(path_);
  map_or_close();
}

bool SealedCopy::send_bytes(int socket) const {
  const std::uint64_t size = bytes_.size();
  return send_all(socket, std::as_bytes(std::span(&size, 1))) && send_all(socket, bytes_);
}

SealedCopy::~SealedCopy() {
  if (!bytes_.empty()) ::munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
  if (fd_ >= 0) ::close(fd_);
}

SealedCopy::SealedCopy(SealedCopy&& other) noexcept
    : path_(std::move(other.path_)),
      fd_(std::exchange(other.fd_, -1)),
      bytes_(std::exchange(other.bytes_, {})) {}

SealedCopy copy_on(files::Disk& disk, const fs::path& path) {
  const auto opened = disk.open(path);
  if (!opened.good()) unreadable_on_disk(path, opened.error_number);
  const files::ClosedOnExit file(disk, opened.value);
  const auto size = disk.size(file.get());
  if (!size.good()) unreadable_on_disk(path, size.error_number);
  const auto read_at = [&](std::uint64_t offset, std::span<std::byte> out) {
    const auto count = disk.read(file.get(), offset, out);
    if (!count.good()) unreadable_on_disk(path, count.error_number);
    if (count.value < out.size()) unreadable(path, "it became shorter meanwhile");
  };
  return SealedCopy(size.value, read_at, path);
}

void SealedCopy::forget_pages() const noexcept {
  if (fd_ >= 0 && !bytes_.empty())
    ::madvise(const_cast<std::byte*>(bytes_.data()), bytes_.size(), MADV_DONTNEED);
}

void SealedCopy::map_or_close() {
  try {
    map();
  } catch (const Error&) {
    ::close(std::exchange(fd_, -1));
    throw;
  }
}

void SealedCopy::map() {
  struct stat info {};
  if (::fstat(fd_, &info) != 0) no_memory(path_);
  if (info.st_size == 0) return;  // nothing to map
  const auto size = static_cast<std::size_t>(info.st_size);
  void* at = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, fd_,
                    0);  // shared: refused of sealed memory before Linux 6.7
  if (at == MAP_FAILED) no_memory(path_);
  bytes_ = {static_cast<const std::byte*>(at), size};
}

}  // namespace thermorig::sandbox
