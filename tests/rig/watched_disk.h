// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <functional>
#include <string_view>
#include <utility>

#include "thermorig/io/files/disk.h"

namespace thermorig::rig::test {

/// The system's disk, and somebody who looks on when a name on it, or what stands in a file, is about to
/// change.
class WatchedDisk : public files::Disk {
 public:
  using Path = std::filesystem::path;
  template <typename Value>
  using Answer = files::Answer<Value>;
  using OpenFile = files::OpenFile;
  using Look = std::function<void(std::string_view call, const Path& path)>;  // no path: of an append
  explicit WatchedDisk(Look look) : look_(std::move(look)) {}

  Answer<OpenFile> create(const Path& path, unsigned mode) override {
    look_("create", path);
    return disk_.create(path, mode);
  }
  int rename(const Path& from, const Path& to) override {
    look_("rename", from);
    return disk_.rename(from, to);
  }
  int rename_to_new(const Path& from, const Path& to) override {
    look_("rename", from);
    return disk_.rename_to_new(from, to);
  }
  int remove(const Path& file) override {
    look_("remove", file);
    return disk_.remove(file);
  }
  Answer<OpenFile> open(const Path& path) override { return disk_.open(path); }
  Answer<OpenFile> open_to_lock(const Path& path) override { return disk_.open_to_lock(path); }
  Answer<std::size_t> append(OpenFile file, std::span<const std::span<const std::byte>> parts) override {
    look_("append", {});
    return disk_.append(file, parts);
  }
  Answer<std::size_t> read(OpenFile file, std::uint64_t offset, std::span<std::byte> out) override {
    return disk_.read(file, offset, out);
  }
  Answer<std::uint64_t> size(OpenFile file) override { return disk_.size(file); }
  int sync(OpenFile file) override { return disk_.sync(file); }
  int reserve(OpenFile file, std::uint64_t bytes) override { return disk_.reserve(file, bytes); }
  int truncate(OpenFile file, std::uint64_t bytes) override { return disk_.truncate(file, bytes); }
  int close(OpenFile file) override { return disk_.close(file); }
  int lock(OpenFile file, Wait wait) override { return disk_.lock(file, wait); }
  Answer<files::FileIdentity> identity(OpenFile file) override { return disk_.identity(file); }
  Answer<files::FileKind> look(const Path& path) override { return disk_.look(path); }
  Answer<std::vector<files::FolderEntry>> list(const Path& folder) override { return disk_.list(folder); }
  int link(const Path& from, const Path& to) override { return disk_.link(from, to); }
  int make_folder(const Path& folder) override { return disk_.make_folder(folder); }
  int remove_folder(const Path& folder) override { return disk_.remove_folder(folder); }
  int sync_folder(const Path& folder) override { return disk_.sync_folder(folder); }
  Answer<std::uint64_t> free_bytes(const Path& path) override { return disk_.free_bytes(path); }

 private:
  files::Disk& disk_ = files::real_disk();
  Look look_;
};

}  // namespace thermorig::rig::test
