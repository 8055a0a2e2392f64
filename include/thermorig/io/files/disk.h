// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace thermorig::files {

/// What a call to a disk gave: `value` means something if `error_number` (of the system, as in errno) is 0.
template <typename Value>
struct Answer {
  Value value{};
  int error_number = 0;
  bool good() const { return error_number == 0; }
};

/// A file or folder that a disk has open; says nothing to another disk.
enum class OpenFile : int { none = -1 };

enum class FileKind : std::uint8_t { missing, file, folder, other };

struct FolderEntry {
  std::filesystem::path path;      // the folder's, and its name
  FileKind kind = FileKind::file;  // of the entry itself: a symbolic link is `other`
};

/// Which file it is: one that took its place differs, and so does one that was written again.
struct FileIdentity {
  std::uint64_t device = 0, inode = 0;
  std::int64_t bytes = 0, changed_ns = 0;

  bool operator==(const FileIdentity&) const = default;
};

/// Every system call that changes a disk on the way from a chunk to a session, and the reading back that
/// belongs to it: nothing else of the journal, of sessions being written and of recovery touches a disk.
/// Tests hand in another one. No call throws or tries again but where a signal interrupted it: functions that
/// return `int` give the system's error number, 0 for none. Calls may come from several threads.
class Disk {
 public:
  enum class Wait : std::uint8_t { no, yes };

  virtual ~Disk() = default;

  // ---- files ------------------------------------------------------------------------------------------

  /// To append to and to read. EEXIST if the name is taken, by a link as well. `mode`: permissions, 0644.
  virtual Answer<OpenFile> create(const std::filesystem::path& path, unsigned mode) = 0;
  /// A file or folder to read, to lock or to sync. Never waits, whatever kind of file it is.
  virtual Answer<OpenFile> open(const std::filesystem::path& path) = 0;
  /// As open(), but so that a lock holds wherever the file system has locks: some of the network lock only
  /// what is open to write. Nothing is ever written through it.
  virtual Answer<OpenFile> open_to_lock(const std::filesystem::path& path) { return open(path); }
  /// All parts (three at most) behind what is there, with one call. May write fewer bytes than it was given.
  virtual Answer<std::size_t> append(OpenFile file, std::span<const std::span<const std::byte>> parts) = 0;
  /// Fewer bytes than asked for only at the end of the file.
  virtual Answer<std::size_t> read(OpenFile file, std::uint64_t offset, std::span<std::byte> out) = 0;
  /// Of a regular file, bytes; EINVAL for whatever else is open.
  virtual Answer<std::uint64_t> size(OpenFile file) = 0;
  /// Bytes and length survive a loss of power. After a failure nothing is known of what was written before:
  /// a second call may succeed although the bytes are lost.
  virtual int sync(OpenFile file) = 0;
  /// A hint that sync() will follow; what fails then fails in sync().
  virtual void begin_sync(OpenFile /*file*/) {}
  /// Space for the file up to `bytes`, beyond its length as well, which stays. EOPNOTSUPP where the file
  /// system cannot.
  virtual int reserve(OpenFile file, std::uint64_t bytes) = 0;
  virtual int truncate(OpenFile file, std::uint64_t bytes) = 0;
  /// The file is closed whatever this returns.
  virtual int close(OpenFile file) = 0;
  /// Until the file is closed or the program dies. EWOULDBLOCK if another has it and Wait::no.
  virtual int lock(OpenFile file, Wait wait) = 0;
  /// For one who will replace the file, beside those who read it: also beside HDF5's readers, not beside one
  /// who has it open to write. EWOULDBLOCK as above; waits for nobody.
  virtual int lock_to_replace(OpenFile file) { return lock(file, Wait::no); }
  virtual Answer<FileIdentity> identity(OpenFile file) = 0;
  /// Gives `to` the owner, the group, the mode and the access list of `from`: its owner only where this user
  /// may give files away.
  virtual int copy_access(OpenFile /*from*/, OpenFile /*to*/) { return 0; }

  // ---- names ------------------------------------------------------------------------------------------

  /// What stands there, links followed.
  virtual Answer<FileKind> look(const std::filesystem::path& path) = 0;
  /// What keeps the file that is there from being replaced, in words ("it is write-protected"); empty:
  /// nothing that could be seen.
  virtual std::string protection(const std::filesystem::path& /*path*/) { return {}; }
  virtual Answer<std::vector<FolderEntry>> list(const std::filesystem::path& folder) = 0;
  virtual int rename(const std::filesystem::path& from, const std::filesystem::path& to) = 0;
  /// EEXIST if `to` is taken. EINVAL or ENOSYS where the file system cannot.
  virtual int rename_to_new(const std::filesystem::path& from, const std::filesystem::path& to) = 0;
  virtual int link(const std::filesystem::path& from, const std::filesystem::path& to) = 0;
  virtual int remove(const std::filesystem::path& file) = 0;
  virtual int make_folder(const std::filesystem::path& folder) = 0;
  virtual int remove_folder(const std::filesystem::path& folder) = 0;  // an empty one
  /// The names in it survive a loss of power.
  virtual int sync_folder(const std::filesystem::path& folder) = 0;

  // ---- space ------------------------------------------------------------------------------------------

  /// For this user, bytes.
  virtual Answer<std::uint64_t> free_bytes(const std::filesystem::path& path) = 0;
};

/// The system's.
Disk& real_disk();

/// All of `bytes` with as many calls as the disk needs: how many it took, and why not more (ENOSPC where it
/// gave no reason).
Answer<std::size_t> append_all(Disk& disk, OpenFile file, std::span<const std::byte> bytes);

/// The folder that a name stands in: "." for a bare one.
std::filesystem::path folder_of(const std::filesystem::path& path);

/// The nearest folder that is there: the rest would be made.
std::filesystem::path existing_part(std::filesystem::path folder);

/// Closes it, whatever happens, when it goes.
class ClosedOnExit {
 public:
  ClosedOnExit(Disk& disk, OpenFile file) : disk_(disk), file_(file) {}
  ~ClosedOnExit() {
    if (file_ != OpenFile::none) disk_.close(file_);
  }
  ClosedOnExit(const ClosedOnExit&) = delete;
  ClosedOnExit& operator=(const ClosedOnExit&) = delete;

  OpenFile get() const { return file_; }

 private:
  Disk& disk_;
  OpenFile file_;
};

}  // namespace thermorig::files
