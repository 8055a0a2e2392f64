// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <random>
#include <string_view>

#include "memory_disk.h"
#include "thermorig/core/time.h"

namespace thermorig::storage_test {

enum class CallKind : std::uint8_t {
  create,
  open,
  append,
  read,
  size,
  sync,
  reserve,
  truncate,
  close,
  lock,
  look,
  list,
  rename,
  rename_to_new,
  link,
  remove,
  make_folder,
  remove_folder,
  sync_folder,
  free_bytes
};
inline constexpr std::array<std::string_view, 20> call_names{
    "create",   "open",   "append",      "read",          "size",        "sync",      "reserve",
    "truncate", "close",  "lock",        "look",          "list",        "rename",    "rename_to_new",
    "link",     "remove", "make_folder", "remove_folder", "sync_folder", "free_bytes"};

/// One call, as it can be made again.
struct Call {
  CallKind kind{};
  HostTime time{};
  files::OpenFile file = files::OpenFile::none;
  std::string path, other_path;
  Bytes bytes;
  std::uint64_t number = 0;
};

/// Makes the call again. Ids of open files are those of the first time if all calls are made again, and none
/// beside them; std::logic_error where an append shows that they are not.
void apply(MemoryDisk& disk, const Call& call);

enum class FaultKind : std::uint8_t {
  io_error,        // EIO, nothing done; a sync drops what it was for
  no_space,        // ENOSPC, nothing done
  short_write,     // half of it, no error
  done_but_error,  // EIO, but it is done all the same
  not_supported    // EOPNOTSUPP
};

struct Fault {
  FaultKind kind = FaultKind::io_error;
  std::size_t call = 0;
  bool lasting = false;  // every call that can fail in this way fails from then on
};

/// Can a call of this kind fail in this way?
bool can_fail(CallKind call, FaultKind fault);

/// Counts and, if asked to, keeps the calls to a disk in memory, and makes one of them fail. The end of a
/// process needs no fault: it leaves what the calls up to then have left.
class FaultDisk : public files::Disk {
 public:
  explicit FaultDisk(MemoryDisk& disk, std::optional<Fault> fault = {}) : disk_(disk), fault_(fault) {}

  void keep_calls(const HostTime* clock) { clock_ = clock, keeps_ = true; }
  const std::vector<Call>& calls() const { return calls_; }
  std::size_t count() const { return count_; }
  bool was_hit() const { return hit_; }
  CallKind kind_hit() const { return kind_hit_; }
  HostTime time_hit() const { return time_hit_; }
  void set_clock(const HostTime* clock) { clock_ = clock; }

  using Path = std::filesystem::path;
  files::Answer<files::OpenFile> create(const Path& path, unsigned mode) override {
    return answered<files::OpenFile>({.kind = CallKind::create, .path = path.string(), .number = mode},
                                     [&] { return disk_.create(path, mode); });
  }
  files::Answer<files::OpenFile> open(const Path& path) override {
    return answered<files::OpenFile>({.kind = CallKind::open, .path = path.string()},
                                     [&] { return disk_.open(path); });
  }
  files::Answer<std::size_t> append(files::OpenFile file,
                                    std::span<const std::span<const std::byte>> parts) override;
  files::Answer<std::size_t> read(files::OpenFile file, std::uint64_t offset,
                                  std::span<std::byte> out) override {
    return answered<std::size_t>({.kind = CallKind::read, .file = file},
                                 [&] { return disk_.read(file, offset, out); });
  }
  files::Answer<std::uint64_t> size(files::OpenFile file) override {
    return answered<std::uint64_t>({.kind = CallKind::size, .file = file}, [&] { return disk_.size(file); });
  }
  int sync(files::OpenFile file) override;
  int reserve(files::OpenFile file, std::uint64_t bytes) override {
    return done({.kind = CallKind::reserve, .file = file, .number = bytes},
                [&] { return disk_.reserve(file, bytes); });
  }
  int truncate(files::OpenFile file, std::uint64_t bytes) override {
    return done({.kind = CallKind::truncate, .file = file, .number = bytes},
                [&] { return disk_.truncate(file, bytes); });
  }
  int close(files::OpenFile file) override {
    return done({.kind = CallKind::close, .file = file}, [&] { return disk_.close(file); });
  }
  int lock(files::OpenFile file, Wait wait) override {
    return done({.kind = CallKind::lock, .file = file}, [&] { return disk_.lock(file, wait); });
  }
  files::Answer<files::FileIdentity> identity(files::OpenFile file) override { return disk_.identity(file); }
  int copy_access(files::OpenFile from, files::OpenFile to) override { return disk_.copy_access(from, to); }
  files::Answer<files::FileKind> look(const Path& path) override {
    return answered<files::FileKind>({.kind = CallKind::look, .path = path.string()},
                                     [&] { return disk_.look(path); });
  }
  files::Answer<std::vector<files::FolderEntry>> list(const Path& folder) override {
    return answered<std::vector<files::FolderEntry>>({.kind = CallKind::list, .path = folder.string()},
                                                     [&] { return disk_.list(folder); });
  }
  int rename(const Path& from, const Path& to) override {
    return done({.kind = CallKind::rename, .path = from.string(), .other_path = to.string()},
                [&] { return disk_.rename(from, to); });
  }
  int rename_to_new(const Path& from, const Path& to) override {
    return done({.kind = CallKind::rename_to_new, .path = from.string(), .other_path = to.string()},
                [&] { return disk_.rename_to_new(from, to); });
  }
  int link(const Path& from, const Path& to) override {
    return done({.kind = CallKind::link, .path = from.string(), .other_path = to.string()},
                [&] { return disk_.link(from, to); });
  }
  int remove(const Path& file) override {
    return done({.kind = CallKind::remove, .path = file.string()}, [&] { return disk_.remove(file); });
  }
  int make_folder(const Path& folder) override {
    return done({.kind = CallKind::make_folder, .path = folder.string()},
                [&] { return disk_.make_folder(folder); });
  }
  int remove_folder(const Path& folder) override {
    return done({.kind = CallKind::remove_folder, .path = folder.string()},
                [&] { return disk_.remove_folder(folder); });
  }
  int sync_folder(const Path& folder) override {
    return done({.kind = CallKind::sync_folder, .path = folder.string()},
                [&] { return disk_.sync_folder(folder); });
  }
  files::Answer<std::uint64_t> free_bytes(const Path& path) override {
    return answered<std::uint64_t>({.kind = CallKind::free_bytes, .path = path.string()},
                                   [&] { return disk_.free_bytes(path); });
  }

 private:
  /// `make` does the call and gives its error number; what the caller shall see of it. It is told of a fault
  /// that lets the call do something.
  using Make = std::function<int(std::optional<FaultKind>)>;
  int with_fault(Call call, const Make& make);

  template <typename Do>
  int done(Call call, Do make) {
    return with_fault(std::move(call), [&](std::optional<FaultKind>) { return make(); });
  }
  template <typename Value, typename Do>
  files::Answer<Value> answered(Call call, Do make) {
    files::Answer<Value> answer;
    const int error_number = done(std::move(call), [&] {
      answer = make();
      return answer.error_number;
    });
    if (error_number == 0) return answer;
    if constexpr (std::is_same_v<Value, files::OpenFile>) return {files::OpenFile::none, error_number};
    return {{}, error_number};
  }

  MemoryDisk& disk_;
  std::optional<Fault> fault_;
  const HostTime* clock_ = nullptr;
  bool keeps_ = false;
  bool hit_ = false;
  CallKind kind_hit_{};
  HostTime time_hit_{};
  std::size_t count_ = 0;
  std::vector<Call> calls_;
};

}  // namespace thermorig::storage_test
