// SPDX-License-Identifier: MIT
#include "journal_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/statvfs.h>
#include <sys/uio.h>
#include <unistd.h>

#include <array>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

#include "thermorig/core/error.h"

namespace thermorig::journal {

namespace {

constexpr double bytes_per_megabyte = 1e6;

std::string advice_for(int error_number) {
  switch (error_number) {
    case ENOSPC:
    case EDQUOT:
      return "free some space, or record to another disk with --output";
    case EACCES:
    case EPERM:
    case EROFS:
      return "choose a folder that you may write to with --output";
    case EEXIST:
      return "choose another name: a journal is never overwritten";
    case ENOENT:
    case ENOTDIR:
      return "create the folder first, or choose another with --output";
    default:
      return "check the disk (dmesg), or record to another one with --output";
  }
}

std::uint64_t free_bytes(int descriptor) {
  struct statvfs disk {};
  if (::fstatvfs(descriptor, &disk) != 0) return UINT64_MAX;  // unknown: let the writes tell
  return static_cast<std::uint64_t>(disk.f_bavail) * disk.f_frsize;
}

std::filesystem::path folder_of(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}

}  // namespace

JournalFile::JournalFile(std::filesystem::path path, std::uint64_t reserve_bytes) : path_(std::move(path)) {
  descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
  if (descriptor_ < 0) refuse("cannot create the journal", errno);
  try {
    reserve(reserve_bytes);
  } catch (...) {
    ::close(descriptor_);
    ::unlink(path_.c_str());
    throw;
  }
}

JournalFile::~JournalFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void JournalFile::reserve(std::uint64_t bytes) {
  const std::uint64_t available = free_bytes(descriptor_);
  if (bytes > available)
    throw Error(
        ExitCode::storage,
        fmt::format("not enough space for the recording: {:.1f} MB needed, {:.1f} MB free, {:.1f} MB missing",
                    static_cast<double>(bytes) / bytes_per_megabyte,
                    static_cast<double>(available) / bytes_per_megabyte,
                    static_cast<double>(bytes - available) / bytes_per_megabyte),
        path_.string(), advice_for(ENOSPC));
  if (bytes == 0) return;
  // KEEP_SIZE: the file stays as long as what was appended, so that a killed recorder leaves no tail of
  // zeros.
  const int result = ::fallocate(descriptor_, FALLOC_FL_KEEP_SIZE, 0, static_cast<off_t>(bytes));
  if (result != 0 && errno != EOPNOTSUPP && errno != ENOSYS) refuse("cannot reserve space", errno);
}

void JournalFile::append(std::span<const std::span<const std::uint8_t>> parts) {
  if (failed_ || descriptor_ < 0) refuse("the journal takes no more records", EIO);
  std::array<iovec, 3> vectors{};
  assert(parts.size() <= vectors.size());
  std::size_t total = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    vectors[i] = {const_cast<std::uint8_t*>(parts[i].data()), parts[i].size()};
    total += parts[i].size();
  }
  const ssize_t written = ::writev(descriptor_, vectors.data(), static_cast<int>(parts.size()));
  if (written == static_cast<ssize_t>(total)) {
    size_ += total;
    return;
  }
  const int error_number = written < 0 ? errno : ENOSPC;  // a short write on a file: the disk is full
  failed_ = true;
  if (::ftruncate(descriptor_, static_cast<off_t>(size_)) != 0) refuse("cannot write", error_number);
  refuse("cannot write", error_number);
}

void JournalFile::sync() {
  if (::fdatasync(descriptor_) != 0) refuse("cannot sync", errno);
}

void JournalFile::sync_folder() {
  const int folder = ::open(folder_of(path_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) refuse("cannot open the folder", errno);
  const int result = ::fsync(folder);
  const int error_number = errno;
  ::close(folder);
  // Some file systems (FUSE, network) do not sync folders; there is nothing better to do there.
  if (result != 0 && error_number != EINVAL) refuse("cannot sync the folder", error_number);
}

void JournalFile::close() {
  if (::ftruncate(descriptor_, static_cast<off_t>(size_)) != 0) refuse("cannot close", errno);
  sync();
  if (::close(std::exchange(descriptor_, -1)) != 0) refuse("cannot close", errno);
}

void JournalFile::refuse(const char* action, int error_number) const {
  throw Error(ExitCode::storage, fmt::format("{}: {}", action, std::strerror(error_number)), path_.string(),
              advice_for(error_number));
}

}  // namespace thermorig::journal
