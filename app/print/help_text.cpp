// SPDX-License-Identifier: MIT
#include "print/help_text.h"

#include <algorithm>

namespace thermorig::app {

namespace {

constexpr std::size_t least_width = 60;
constexpr std::size_t name_width = 28;  // of CLI11: what an option does begins behind it

/// Where what an option does begins in a line; 0 of a line of another kind.
std::size_t meaning_at(const std::string& line) {
  const std::size_t begin = std::min(line.find_first_not_of(' '), line.size());
  const std::size_t at = begin < name_width ? begin + name_width : begin;
  const bool is_one = begin > 0 && at < line.size() && line[at - 1] == ' ' && line[at] != ' ' &&
                      !line.starts_with("  thermorig");
  return is_one ? at : 0;
}

/// A line that is longer than `width` goes on below where its meaning begins.
std::string wrapped(std::string line, std::size_t width) {
  const std::size_t indent = meaning_at(line);
  if (indent == 0 && line.starts_with(' ')) return line + "\n";
  std::string text;
  while (line.size() > width) {
    const std::size_t end = line.rfind(' ', width);
    if (end == std::string::npos || end <= indent) break;
    text += line.substr(0, end) + "\n";
    line = std::string(indent, ' ') + line.substr(end + 1);
  }
  return text + line + "\n";
}

}  // namespace

std::string help_text(const std::string& help, std::size_t width) {
  std::string text;
  for (std::size_t at = 0; at < help.size();) {
    const std::size_t end = std::min(help.find('\n', at), help.size());
    text += wrapped(help.substr(at, end - at), std::max(width, least_width));
    at = end + 1;
  }
  return text;
}

}  // namespace thermorig::app
