// SPDX-License-Identifier: MIT
#include "thermorig/storage/session/stored_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <string_view>
#include <utility>

#include "thermorig/core/error.h"
#include "thermorig/core/git_lfs.h"
#include "thermorig/core/printable.h"
#include "thermorig/io/files/descriptor.h"

namespace thermorig::session {

namespace {

namespace fs = std::filesystem;
using files::Descriptor;

[[noreturn]] void cannot_open(const fs::path& path, int error_number) {
  const std::string what = std::string("cannot be opened: ") + std::strerror(error_number);
  if (error_number != EACCES && error_number != EPERM) refuse(path, what);
  throw Error(ExitCode::no_permission, what, path.string(),
              "see who may read it: ls -l " + shell_word(path.string()));
}

[[noreturn]] void unreadable(const fs::path& path, const char* why) {
  throw Error(ExitCode::storage, std::string("cannot be read: ") + why, path.string(),
              "check the disk (dmesg), and copy the file to another one");
}

[[noreturn]] void unreadable_on_disk(const fs::path& path, int error_number) {
  throw Error(ExitCode::not_a_session, std::string("cannot be read: ") + std::strerror(error_number),
              path.string(), "check the disk (dmesg)");
}

/// Looked at before it is opened: opening a pipe waits, and opening a port moves its lines.
Descriptor open_regular(const fs::path& path, std::uint64_t& size) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) cannot_open(path, errno);
  if (S_ISDIR(info.st_mode))
    throw Error(ExitCode::not_a_session, "this is a folder, not a session", path.string(),
                "name the session files (.h5) in it, or below it");
  if (!S_ISREG(info.st_mode)) refuse(path, "is not a regular file");
  Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
  if (!file) cannot_open(path, errno);
  if (::fstat(file.get(), &info) != 0 || !S_ISREG(info.st_mode)) refuse(path, "is not a regular file");
  size = static_cast<std::uint64_t>(info.st_size);
  return file;
}

void read_descriptor(int file, std::uint64_t offset, std::span<std::byte> out, const fs::path& path) {
  while (!out.empty()) {
    const ssize_t size = ::pread(file, out.data(), out.size(), static_cast<off_t>(offset));
    if (size < 0 && errno == EINTR) continue;
    if (size < 0) unreadable(path, std::strerror(errno));
    if (size == 0) unreadable(path, "it became shorter meanwhile");
    offset += static_cast<std::uint64_t>(size);
    out = out.subspan(static_cast<std::size_t>(size));
  }
}

}  // namespace

void refuse(const fs::path& path, const std::string& what) {
  throw Error(ExitCode::not_a_session, what, path.string(),
              "name a session that thermorig wrote; if this is one, it is damaged: take a copy of it from "
              "elsewhere, or its journal with thermorig recover");
}

StoredFile::StoredFile(std::uint64_t size, ReadAt read_at, fs::path path)
    : path_(std::move(path)), size_(size), read_at_(std::move(read_at)) {
  if (size_ > bytes_max) refuse(path_, "is larger than any session: 4 GiB");
}

StoredFile::StoredFile(const fs::path& path) : path_(path) {
  const auto file = std::make_shared<const Descriptor>(open_regular(path, size_));
  const auto read_at = [file, path](std::uint64_t offset, std::span<std::byte> out) {
    read_descriptor(file->get(), offset, out, path);
  };
  *this = StoredFile(size_, read_at, path);
  // The pointers that stand for sessions in a clone without git-lfs have fewer bytes than this (their
  // specification), and no session has so few.
  std::array<std::byte, 1024> head{};
  if (size_ > head.size()) return;
  read(0, head);
  if (is_git_lfs_pointer({reinterpret_cast<const char*>(head.data()), static_cast<std::size_t>(size_)}))
    throw Error(ExitCode::not_a_session, "is a Git LFS pointer: the file itself was not fetched",
                path.string(), git_lfs_advice);
}

StoredFile::StoredFile(files::Disk& disk, const fs::path& path) : path_(path) {
  const auto opened = disk.open(path);
  if (!opened.good()) unreadable_on_disk(path, opened.error_number);
  const auto file = std::make_shared<const files::ClosedOnExit>(disk, opened.value);
  const auto size = disk.size(file->get());
  if (!size.good()) unreadable_on_disk(path, size.error_number);
  const auto read_at = [&disk, file, path](std::uint64_t offset, std::span<std::byte> out) {
    const auto count = disk.read(file->get(), offset, out);
    if (!count.good()) unreadable_on_disk(path, count.error_number);
    if (count.value < out.size()) unreadable(path, "it became shorter meanwhile");
  };
  *this = StoredFile(size.value, read_at, path);
}

void StoredFile::read(std::uint64_t offset, std::span<std::byte> out) const {
  const std::uint64_t there = offset < size_ ? std::min<std::uint64_t>(out.size(), size_ - offset) : 0;
  if (there > 0) read_at_(offset, out.first(there));
  std::ranges::fill(out.subspan(there), std::byte{0});
}

std::uint64_t StoredFile::stated_end() const {
  constexpr std::string_view signature("\x89HDF\r\n\x1a\n\0", 9);  // and the version
  constexpr std::size_t end_at = 40;
  std::array<std::byte, end_at + sizeof(std::uint64_t)> head{};
  if (size_ < head.size()) return 0;
  read(0, head);
  if (std::memcmp(head.data(), signature.data(), signature.size()) != 0) return 0;
  std::uint64_t end = 0;
  std::memcpy(&end, &head[end_at], sizeof end);
  return end;
}

}  // namespace thermorig::session
