// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace thermorig::publication {

/// Hexadecimal. Throws Error(storage) if the file cannot be read.
std::string sha256_of_file(const std::filesystem::path& path);
std::string sha256_of(std::string_view text);

}  // namespace thermorig::publication
