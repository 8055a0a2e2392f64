// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace thermorig::rig {

/// A TOML text as the parser may see it: UTF-8, of bounded depth, and of short lines, since for each value
/// the parser looks through the whole line.
struct TomlText {
  std::string text;
  std::vector<std::size_t> lines;  // of each line of `text`: the number, from 1, that it has in the file
};

/// Long lists are broken into lines. Throws Error(bad_usage), with file and line, for what is not UTF-8,
/// nested deeper than 32 (open brackets, and the dots of a key), or has a line of more than 4096 bytes
/// without a list in it.
TomlText prepared_toml(const std::string& text, const std::string& file_name);

/// A file as text. Throws Error(bad_usage), before anything is read, unless it is a regular file of at most
/// 1 MB.
std::string read_text_file(const std::string& path, const std::string& what);

}  // namespace thermorig::rig
