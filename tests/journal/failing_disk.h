// SPDX-License-Identifier: MIT
#pragma once

#include <limits>
#include <map>
#include <string>

#include "thermorig/io/files/disk.h"

namespace thermorig::journal {

/// The system's disk; the calls that `errors` names fail with that number, each time.
class FailingDisk : public files::Disk {
 public:
  using Path = std::filesystem::path;
  using Parts = std::span<const std::span<const std::byte>>;

  std::map<std::string, int> errors;
  std::size_t most_at_once = std::numeric_limits<std::size_t>::max();  // bytes that one append takes
  std::uint64_t phantom_bytes = 0;  // that a file has when it is looked at, and has no more when it is read

  files::Answer<files::OpenFile> create(const Path& path, unsigned mode) override {
    if (const int error = failure("create")) return {files::OpenFile::none, error};
    return disk_.create(path, mode);
  }
  files::Answer<files::OpenFile> open(const Path& path) override {
    if (const int error = failure("open")) return {files::OpenFile::none, error};
    return disk_.open(path);
  }
  files::Answer<std::size_t> append(files::OpenFile file, Parts parts) override {
    if (const int error = failure("append")) return {0, error};
    for (const auto part : parts) {
      if (part.empty()) continue;
      if (part.size() <= most_at_once) return disk_.append(file, {&part, 1});
      const auto front = part.first(most_at_once);
      return disk_.append(file, {&front, 1});
    }
    return {};
  }
  files::Answer<std::size_t> read(files::OpenFile file, std::uint64_t offset,
                                  std::span<std::byte> out) override {
    if (const int error = failure("read")) return {0, error};
    return disk_.read(file, offset, out);
  }
  files::Answer<std::uint64_t> size(files::OpenFile file) override {
    if (const int error = failure("size")) return {0, error};
    auto size = disk_.size(file);
    size.value += phantom_bytes;
    return size;
  }
  int sync(files::OpenFile file) override {
    return or_call("sync", [&] { return disk_.sync(file); });
  }
  int reserve(files::OpenFile file, std::uint64_t bytes) override {
    return or_call("reserve", [&] { return disk_.reserve(file, bytes); });
  }
  int truncate(files::OpenFile file, std::uint64_t bytes) override {
    return or_call("truncate", [&] { return disk_.truncate(file, bytes); });
  }
  int close(files::OpenFile file) override {
    const int error = disk_.close(file);
    return failure("close") != 0 ? failure("close") : error;
  }
  int sync_folder(const Path& folder) override {
    return or_call("sync_folder", [&] { return disk_.sync_folder(folder); });
  }
  files::Answer<std::uint64_t> free_bytes(const Path& path) override {
    if (const int error = failure("free_bytes")) return {0, error};
    return disk_.free_bytes(path);
  }
  int remove(const Path& file) override { return disk_.remove(file); }

  // Not for journals.
  int lock(files::OpenFile file, Wait wait) override { return disk_.lock(file, wait); }
  int lock_to_replace(files::OpenFile file) override { return disk_.lock_to_replace(file); }
  files::Answer<files::FileIdentity> identity(files::OpenFile file) override { return disk_.identity(file); }
  int copy_access(files::OpenFile from, files::OpenFile to) override {
    return or_call("copy_access", [&] { return disk_.copy_access(from, to); });
  }
  files::Answer<files::FileKind> look(const Path& path) override {
    if (const int error = failure("look")) return {files::FileKind::missing, error};
    return disk_.look(path);
  }
  files::Answer<std::vector<files::FolderEntry>> list(const Path& folder) override {
    return disk_.list(folder);
  }
  int rename(const Path& from, const Path& to) override { return disk_.rename(from, to); }
  int rename_to_new(const Path& from, const Path& to) override { return disk_.rename_to_new(from, to); }
  int link(const Path& from, const Path& to) override { return disk_.link(from, to); }
  int make_folder(const Path& folder) override { return disk_.make_folder(folder); }
  int remove_folder(const Path& folder) override { return disk_.remove_folder(folder); }

 private:
  int failure(const std::string& call) const {
    const auto found = errors.find(call);
    return found == errors.end() ? 0 : found->second;
  }
  template <typename Call>
  int or_call(const std::string& name, Call call) const {
    const int error = failure(name);
    return error != 0 ? error : call();
  }

  files::Disk& disk_ = files::real_disk();
};

}  // namespace thermorig::journal
