// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "thermorig/io/files/descriptor.h"
#include "thermorig/storage/session/stored_file.h"

namespace thermorig::publication {

/// A path within the folder of a data set, with '/'; and why it cannot be part of one, empty if it can: a
/// data set is regular files below one folder, and no links, so that it is the same wherever it is copied to.
struct FolderPath {
  std::string path;
  std::string problem;
};

/// Whatever is called `*.h5` in the folder, at any depth, and folders that links lead to; by path. Throws
/// Error: storage if a folder may not be searched, bad_usage for what is no folder.
std::vector<FolderPath> sessions_in(const std::filesystem::path& folder);

/// A file of a data set, open. No link is followed below the folder, no pipe waited for, no device touched.
class FolderFile {
 public:
  /// What cannot be opened has a problem(). Throws Error(no_permission) for what may not be read.
  FolderFile(const std::filesystem::path& folder, const std::string& path);

  const std::string& problem() const { return problem_; }
  bool is_missing() const { return is_missing_; }
  /// As many as it had when it was opened: no more are read.
  std::uint64_t bytes() const { return bytes_; }
  /// Throws Error(storage).
  void read(std::uint64_t offset, std::span<std::byte> out) const;
  /// Hexadecimal. Throws as read().
  std::string sha256() const;

 private:
  void step_into(const std::filesystem::path& name, bool is_last);

  std::filesystem::path path_;
  files::Descriptor file_;  // a folder on the way, until it is the file
  std::uint64_t bytes_ = 0;
  std::string problem_;
  bool is_missing_ = false;
};

}  // namespace thermorig::publication
