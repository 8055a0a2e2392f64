// SPDX-License-Identifier: MIT
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sys/uio.h>
#include <unistd.h>

#include <array>
#include <cassert>
#include <cerrno>
#include <cstdio>
#include <system_error>

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

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

}  // namespace thermorig::files
