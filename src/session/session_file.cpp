// SPDX-License-Identifier: MIT
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <span>
#include <thread>

#include "chunk_writer.h"
#include "hdf5_handle.h"
#include "session_image.h"
#include "thermorig/core/error.h"
#include "thermorig/session/session.h"

namespace thermorig::session {

namespace {

namespace fs = std::filesystem;

std::string advice_for(int error_number) {
  switch (error_number) {
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
      return "free some space or choose another disk, then run thermorig recover: the journal is still there";
    case EACCES:
    case EPERM:
    case EROFS:
      return "choose a folder that you may write to with --output";
    case EEXIST:
      return "choose another name: a session is never overwritten";
    case ENOENT:
    case ENOTDIR:
      return "create the folder first, or choose another with --output";
    default:
      return "check the disk (dmesg), then run thermorig recover: the journal is still there";
  }
}

[[noreturn]] void refuse(const std::string& action, int error_number, const fs::path& path) {
  throw Error(ExitCode::storage, fmt::format("{}: {}", action, std::strerror(error_number)), path.string(),
              advice_for(error_number));
}

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// `<path>.<process>.part`: exists only while a session is being written, and goes with this object.
class PartFile {
 public:
  explicit PartFile(const fs::path& path) : path_(fmt::format("{}.{}.part", path.string(), ::getpid())) {
    descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0644);
    if (descriptor_ < 0) refuse("cannot create the session", errno, path_);
  }
  ~PartFile() {
    ::close(descriptor_);
    if (!published_) ::unlink(path_.c_str());
  }
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  void write(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
      const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
      if (count < 0 && errno != EINTR)
        refuse(fmt::format("cannot write the session ({} bytes missing)", bytes.size()), errno, path_);
      if (count > 0) bytes = bytes.subspan(static_cast<std::size_t>(count));
    }
  }

  void sync() {
    if (::fsync(descriptor_) != 0) refuse("cannot sync the session", errno, path_);
  }

  void publish(const fs::path& path, bool overwrite) {
    const int result = overwrite ? ::rename(path_.c_str(), path.c_str()) : rename_to_new(path);
    if (result != 0) refuse("cannot name the session", errno, path);
    published_ = true;
  }

  const fs::path& path() const { return path_; }

 private:
  int rename_to_new(const fs::path& path) {
    const int result = ::renameat2(AT_FDCWD, path_.c_str(), AT_FDCWD, path.c_str(), RENAME_NOREPLACE);
    if (result == 0 || (errno != EINVAL && errno != ENOSYS)) return result;
    // A file system without RENAME_NOREPLACE: a hard link refuses an existing name as well.
    if (::link(path_.c_str(), path.c_str()) != 0) return -1;
    return ::unlink(path_.c_str());
  }

  fs::path path_;
  int descriptor_ = -1;
  bool published_ = false;
};

void sync_folder(const fs::path& path) {
  const int folder = ::open(folder_of(path).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) refuse("cannot open the folder", errno, folder_of(path));
  const int result = ::fsync(folder);
  const int error_number = errno;
  ::close(folder);
  // Some file systems (FUSE, network) do not sync folders; there is nothing better to do there.
  if (result != 0 && error_number != EINVAL) refuse("cannot sync the folder", error_number, folder_of(path));
}

void write_file(const fs::path& path, const Session& session, bool overwrite) {
  if (!overwrite && fs::exists(fs::symlink_status(path))) refuse("the session exists already", EEXIST, path);
  PartFile part(path);
  const SessionImage image = build_image(session, std::thread::hardware_concurrency());
  part.write(image.bytes);
  check_written(part.path().string(), image.datasets);
  part.sync();
  part.publish(path, overwrite);
  sync_folder(path);
}

void write_or_explain(const fs::path& path, const Session& session, bool overwrite) {
  try {
    write_file(path, session, overwrite);
  } catch (const Hdf5Failure& failure) {
    throw Error(ExitCode::storage, failure.what(), path.string(), advice_for(EIO));
  } catch (const fs::filesystem_error& failure) {
    refuse("cannot look at the folder", failure.code().value(), path);
  }
}

}  // namespace

void write_session(const fs::path& path, const Session& session) {
  write_or_explain(path, session, false);
}

void replace_session(const fs::path& path, const Session& session) {
  write_or_explain(path, session, true);
}

}  // namespace thermorig::session
