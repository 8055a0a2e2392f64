// SPDX-License-Identifier: MIT
#include <fcntl.h>
#include <linux/limits.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sys/uio.h>
#include <sys/xattr.h>
#include <unistd.h>

#include <array>
#include <cassert>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <system_error>
#include <vector>

#include "thermorig/io/files/disk.h"

namespace thermorig::files {

namespace {

namespace fs = std::filesystem;

int descriptor_of(OpenFile file) {
  return static_cast<int>(file);
}

/// Calls again where a signal came in between.
template <typename Call>
auto uninterrupted(Call call) {
  auto result = call();
  while (result < 0 && errno == EINTR) result = call();
  return result;
}

int error_of(int result) {
  return result < 0 ? errno : 0;
}

Answer<OpenFile> opened(int descriptor) {
  if (descriptor < 0) return {OpenFile::none, errno};
  return {static_cast<OpenFile>(descriptor), 0};
}

FileKind kind_of(fs::file_type type) {
  switch (type) {
    case fs::file_type::not_found:
      return FileKind::missing;
    case fs::file_type::regular:
      return FileKind::file;
    case fs::file_type::directory:
      return FileKind::folder;
    default:
      return FileKind::other;
  }
}

/// A rename asks the folder alone, and root may do all: who took a file's write permission away wants it
/// kept.
bool is_write_protected(const fs::path& file, const struct stat& info) {
  constexpr mode_t writable = S_IWUSR | S_IWGRP | S_IWOTH;
  return (info.st_mode & writable) == 0 || ::access(file.c_str(), W_OK) != 0;
}

/// In such a folder (/tmp) each one's files are his own.
bool is_of_another_in_a_sticky_folder(const fs::path& file, const struct stat& info) {
  struct stat folder {};
  const uid_t own = ::geteuid();
  return own != 0 && info.st_uid != own && ::stat(folder_of(file).c_str(), &folder) == 0 &&
         (folder.st_mode & S_ISVTX) != 0 && folder.st_uid != own;
}

/// Beside its mode a file has a list of access. None of its own: the file that takes its place may have got
/// one from the folder.
int copy_access_list(int from, int to) {
  constexpr const char* name = "system.posix_acl_access";
  std::vector<char> list(XATTR_SIZE_MAX);
  const ssize_t bytes = ::fgetxattr(from, name, list.data(), list.size());
  if (bytes >= 0) return error_of(::fsetxattr(to, name, list.data(), static_cast<std::size_t>(bytes), 0));
  return errno == ENODATA && ::fremovexattr(to, name) != 0 && errno != ENODATA ? errno : 0;
}

class RealDisk final : public Disk {
 public:
  Answer<OpenFile> create(const fs::path& path, unsigned mode) override {
    constexpr int flags = O_RDWR | O_CREAT | O_EXCL | O_APPEND | O_NOFOLLOW | O_CLOEXEC;
    return opened(uninterrupted([&] { return ::open(path.c_str(), flags, static_cast<mode_t>(mode)); }));
  }

  Answer<OpenFile> open(const fs::path& path) override {
    // NONBLOCK: a pipe without a writer would hold the program for good.
    return opened(uninterrupted([&] { return ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC); }));
  }

  Answer<OpenFile> open_to_lock(const fs::path& path) override {
    const int descriptor =
        uninterrupted([&] { return ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC | O_NOCTTY); });
    return descriptor < 0 ? open(path) : opened(descriptor);  // a folder, or one that may not be written
  }

  Answer<std::size_t> append(OpenFile file, std::span<const std::span<const std::byte>> parts) override {
    std::array<iovec, 3> vectors{};
    assert(parts.size() <= vectors.size());
    for (std::size_t i = 0; i < parts.size(); ++i)
      vectors[i] = {const_cast<std::byte*>(parts[i].data()), parts[i].size()};
    const ssize_t count = uninterrupted(
        [&] { return ::writev(descriptor_of(file), vectors.data(), static_cast<int>(parts.size())); });
    if (count < 0) return {0, errno};
    return {static_cast<std::size_t>(count), 0};
  }

  Answer<std::size_t> read(OpenFile file, std::uint64_t offset, std::span<std::byte> out) override {
    std::size_t done = 0;
    while (done < out.size()) {
      const ssize_t count = uninterrupted([&] {
        return ::pread(descriptor_of(file), out.data() + done, out.size() - done,
                       static_cast<off_t>(offset + done));
      });
      if (count < 0) return {done, errno};
      if (count == 0) break;
      done += static_cast<std::size_t>(count);
    }
    return {done, 0};
  }

  Answer<std::uint64_t> size(OpenFile file) override {
    struct stat info {};
    if (::fstat(descriptor_of(file), &info) != 0) return {0, errno};
    if (!S_ISREG(info.st_mode)) return {0, EINVAL};
    return {static_cast<std::uint64_t>(info.st_size), 0};
  }

  int sync(OpenFile file) override {
    return error_of(uninterrupted([&] { return ::fdatasync(descriptor_of(file)); }));
  }

  void begin_sync(OpenFile file) override {
    ::sync_file_range(descriptor_of(file), 0, 0, SYNC_FILE_RANGE_WRITE);
  }

  int reserve(OpenFile file, std::uint64_t bytes) override {
    return error_of(uninterrupted(
        [&] { return ::fallocate(descriptor_of(file), FALLOC_FL_KEEP_SIZE, 0, static_cast<off_t>(bytes)); }));
  }

  int truncate(OpenFile file, std::uint64_t bytes) override {
    return error_of(
        uninterrupted([&] { return ::ftruncate(descriptor_of(file), static_cast<off_t>(bytes)); }));
  }

  int close(OpenFile file) override {
    // Linux has closed it even if a signal came in between: trying again would close another's.
    const int result = ::close(descriptor_of(file));
    return result != 0 && errno == EINTR ? 0 : error_of(result);
  }

  int lock(OpenFile file, Wait wait) override {
    const int operation = wait == Wait::yes ? LOCK_EX : LOCK_EX | LOCK_NB;
    return error_of(uninterrupted([&] { return ::flock(descriptor_of(file), operation); }));
  }

  int lock_to_replace(OpenFile file) override {
    // HDF5 holds such a lock, shared if it only reads; a reader that opens the file later still gets his.
    if (::flock(descriptor_of(file), LOCK_SH | LOCK_NB) != 0) return errno;
    // Of two who replace it the other kind of lock lets one go on.
    struct flock whole {};
    whole.l_type = F_WRLCK;
    const int error_number = error_of(::fcntl(descriptor_of(file), F_OFD_SETLK, &whole));
    return error_number == EACCES ? EWOULDBLOCK : error_number;
  }

  Answer<FileIdentity> identity(OpenFile file) override {
    constexpr std::int64_t ns_per_s = 1'000'000'000;
    struct stat info {};
    if (::fstat(descriptor_of(file), &info) != 0) return {{}, errno};
    return {{info.st_dev, info.st_ino, info.st_size, ns_per_s * info.st_mtim.tv_sec + info.st_mtim.tv_nsec},
            0};
  }

  int copy_access(OpenFile from, OpenFile to) override {
    const int source = descriptor_of(from), target = descriptor_of(to);
    struct stat wanted {
    }, given{};
    if (::fstat(source, &wanted) != 0 || ::fstat(target, &given) != 0) return errno;
    const bool is_same = wanted.st_uid == given.st_uid && wanted.st_gid == given.st_gid;
    // Whoever shares a file by its group may go on to do so: the file then is his who wrote it last.
    if (!is_same && ::fchown(target, wanted.st_uid, wanted.st_gid) != 0 &&
        (wanted.st_gid != given.st_gid && ::fchown(target, static_cast<uid_t>(-1), wanted.st_gid) != 0))
      return errno;
    if (const int error_number = copy_access_list(source, target)) return error_number;
    if (::fstat(target, &given) != 0) return errno;
    return given.st_mode == wanted.st_mode ? 0 : error_of(::fchmod(target, wanted.st_mode & ALLPERMS));
  }

  std::string protection(const fs::path& path) override {
    struct stat info {};
    if (::stat(path.c_str(), &info) != 0) return {};
    if (is_write_protected(path, info)) return "it is write-protected";
    if (is_of_another_in_a_sticky_folder(path, info)) return "in this folder only its owner may replace it";
    struct statx more {};
    if (::statx(AT_FDCWD, path.c_str(), 0, STATX_BASIC_STATS, &more) != 0) return {};
    if ((more.stx_attributes & STATX_ATTR_MOUNT_ROOT) != 0) return "it is mounted by itself (a bind mount)";
    if ((more.stx_attributes & (STATX_ATTR_IMMUTABLE | STATX_ATTR_APPEND)) != 0)
      return "it is locked against changes (chattr)";
    return {};
  }

  Answer<FileKind> look(const fs::path& path) override {
    std::error_code failure;
    const fs::file_status status = fs::status(path, failure);
    if (status.type() == fs::file_type::not_found) return {FileKind::missing, 0};
    return {kind_of(status.type()), failure.value()};
  }

  Answer<std::vector<FolderEntry>> list(const fs::path& folder) override {
    Answer<std::vector<FolderEntry>> entries;
    std::error_code failure;
    for (fs::directory_iterator at(folder, failure), end; !failure && at != end; at.increment(failure)) {
      std::error_code vanished;
      entries.value.push_back({at->path(), kind_of(at->symlink_status(vanished).type())});
    }
    entries.error_number = failure.value();
    return entries;
  }

  int rename(const fs::path& from, const fs::path& to) override {
    return error_of(::rename(from.c_str(), to.c_str()));
  }

  int rename_to_new(const fs::path& from, const fs::path& to) override {
    return error_of(::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE));
  }

  int link(const fs::path& from, const fs::path& to) override {
    return error_of(::link(from.c_str(), to.c_str()));
  }

  int remove(const fs::path& file) override { return error_of(::unlink(file.c_str())); }

  int make_folder(const fs::path& folder) override { return error_of(::mkdir(folder.c_str(), 0777)); }

  int remove_folder(const fs::path& folder) override { return error_of(::rmdir(folder.c_str())); }

  int sync_folder(const fs::path& folder) override {
    const int descriptor =
        uninterrupted([&] { return ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); });
    if (descriptor < 0) return errno;
    const int error_number = error_of(uninterrupted([&] { return ::fsync(descriptor); }));
    ::close(descriptor);
    // Some file systems (FUSE, network) do not sync folders; there is nothing better to do there.
    return error_number == EINVAL ? 0 : error_number;
  }

  Answer<std::uint64_t> free_bytes(const fs::path& path) override {
    struct statvfs disk {};
    if (uninterrupted([&] { return ::statvfs(path.c_str(), &disk); }) != 0) return {0, errno};
    return {static_cast<std::uint64_t>(disk.f_bavail) * disk.f_frsize, 0};
  }
};

}  // namespace

Disk& real_disk() {
  static RealDisk disk;
  return disk;
}

Answer<std::size_t> append_all(Disk& disk, OpenFile file, std::span<const std::byte> bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const auto rest = bytes.subspan(done);
    const auto written = disk.append(file, {&rest, 1});
    if (!written.good()) return {done, written.error_number};
    if (written.value == 0) return {done, ENOSPC};
    done += written.value;
  }
  return {done, 0};
}

fs::path existing_part(fs::path folder) {
  std::error_code ignored;
  folder = fs::absolute(folder, ignored);
  while (!fs::exists(folder, ignored) && folder.has_relative_path()) folder = folder.parent_path();
  return folder;
}

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

}  // namespace thermorig::files
