// SPDX-License-Identifier: MIT
#include "thermorig/files/part_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "thermorig/core/error.h"

namespace thermorig::files {

std::string usual_advice(int error_number) {
  switch (error_number) {
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
      return "free some space or choose another disk";
    case EACCES:
    case EPERM:
    case EROFS:
      return "choose a folder that you may write to";
    case EEXIST:
    case EISDIR:
      return "choose another name";
    case ENOENT:
    case ENOTDIR:
      return "create the folder first, or choose another";
    default:
      return "check the disk (dmesg)";
  }
}

PartFile::PartFile(std::filesystem::path path, std::string noun, Advice advice)
    : path_(std::move(path)),
      part_path_(fmt::format("{}.{}.part", path_.string(), ::getpid())),
      noun_(std::move(noun)),
      advice_(advice) {
  descriptor_ = ::open(part_path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0644);
  if (descriptor_ < 0) refuse("cannot create " + noun_, errno, part_path_);
}

PartFile::~PartFile() {
  ::close(descriptor_);
  if (!published_) ::unlink(part_path_.c_str());
}

void PartFile::refuse(const std::string& action, int error_number, const std::filesystem::path& where) const {
  throw Error(ExitCode::storage, fmt::format("{}: {}", action, std::strerror(error_number)), where.string(),
              advice_(error_number));
}

void PartFile::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
    if (count < 0 && errno != EINTR)
      refuse(fmt::format("cannot write {} ({} bytes missing)", noun_, bytes.size()), errno, part_path_);
    if (count > 0) bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
}

void PartFile::sync() {
  if (::fsync(descriptor_) != 0) refuse("cannot sync " + noun_, errno, part_path_);
}

int PartFile::rename_to_new() const {
  const int result = ::renameat2(AT_FDCWD, part_path_.c_str(), AT_FDCWD, path_.c_str(), RENAME_NOREPLACE);
  if (result == 0 || (errno != EINVAL && errno != ENOSYS)) return result;
  // A file system without RENAME_NOREPLACE: a hard link refuses an existing name as well.
  if (::link(part_path_.c_str(), path_.c_str()) != 0) return -1;
  return ::unlink(part_path_.c_str());
}

void PartFile::sync_folder() const {
  const auto folder_path = path_.has_parent_path() ? path_.parent_path() : std::filesystem::path(".");
  const int folder = ::open(folder_path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) refuse("cannot open the folder", errno, folder_path);
  const int result = ::fsync(folder);
  const int error_number = errno;
  ::close(folder);
  // Some file systems (FUSE, network) do not sync folders; there is nothing better to do there.
  if (result != 0 && error_number != EINVAL) refuse("cannot sync the folder", error_number, folder_path);
}

void PartFile::publish(bool overwrite) {
  const int result = overwrite ? ::rename(part_path_.c_str(), path_.c_str()) : rename_to_new();
  if (result != 0) refuse("cannot name " + noun_, errno, path_);
  published_ = true;
  sync_folder();
}

}  // namespace thermorig::files
