// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string_view>

namespace thermorig::training {

/// Writes a file that is there whole or not at all: to a temporary name in the same folder, synced, renamed
/// over what was there. Throws Error(storage).
void write_whole(const std::filesystem::path& path, std::string_view bytes);

}  // namespace thermorig::training
