// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

namespace thermorig::app {

/// Throws Error(bad_usage) if there is nothing at `path`: the same words and code for every command.
void require_existing(const std::filesystem::path& path);

}  // namespace thermorig::app
