// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace thermorig::files {

/// Which file stands under a name: one that took its place differs, and so does one that was written again.
struct FileIdentity {
  std::uint64_t device = 0, inode = 0;
  std::int64_t bytes = 0, changed_ns = 0;

  bool operator==(const FileIdentity&) const = default;
};

/// Links are followed. None where there is nothing.
std::optional<FileIdentity> identity_of(const std::filesystem::path& path);

/// Where a symbolic link leads, also if nothing is there yet; any other path as it is.
std::filesystem::path behind_links(std::filesystem::path path);

}  // namespace thermorig::files
