// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "thermorig/io/files/part_file.h"

namespace thermorig::files {

/// Writes all or nothing, in the place of an older file (ReplacedFile) or for the first time. Throws
/// Error(storage), and Error(no_permission) where another program is writing it.
void write_whole(const std::filesystem::path& path, std::string_view bytes, const std::string& noun,
                 Advice advice = usual_advice);

/// The same, but never over another file: false, and nothing is written, where there is one.
bool write_whole_if_free(const std::filesystem::path& path, std::string_view bytes, const std::string& noun,
                         Advice advice = usual_advice);

/// The bytes of a regular file of at most `bytes_max`. Throws Error(not_a_session), before anything is read,
/// for what is missing, larger, a folder or a pipe; Error(no_permission) for what may not be read.
std::vector<std::uint8_t> read_whole(const std::filesystem::path& path, std::size_t bytes_max,
                                     const std::string& noun);

}  // namespace thermorig::files
