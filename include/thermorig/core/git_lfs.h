// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

namespace thermorig {

/// Whether a file holds a Git LFS pointer in place of what it is named after: a clone without git-lfs does.
inline bool is_git_lfs_pointer(std::string_view first_bytes) {
  return first_bytes.starts_with("version https://git-lfs.github.com/spec/");
}

inline constexpr const char* git_lfs_advice = "git lfs pull (in the clone; git-lfs has to be installed)";

}  // namespace thermorig
