// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

namespace thermorig::files {

/// The nearest folder that is there: the rest would be made.
std::filesystem::path existing_part(std::filesystem::path folder);

/// What forbids a file at `path`, new or in place of an older one, in words; empty: nothing. A folder that is
/// not there counts as one that would be made.
std::string hindrance_of_writing(const std::filesystem::path& path);

}  // namespace thermorig::files
