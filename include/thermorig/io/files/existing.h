// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

namespace thermorig::files {

/// Throws Error(bad_usage) if there is nothing at `path`, and what a link leads to instead: the same words
/// and code for every command.
void require_existing(const std::filesystem::path& path);

}  // namespace thermorig::files
