// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace thermorig::doctor {

/// The first line of a small file of the system, without its end; empty if it cannot be read.
std::string first_line(const std::filesystem::path& file);

/// At most the first 4096 lines of a file; none if it cannot be read.
std::vector<std::string> lines_of(const std::filesystem::path& file);

std::vector<std::string> split(const std::string& text, char at);

}  // namespace thermorig::doctor
