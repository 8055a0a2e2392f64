// SPDX-License-Identifier: MIT
#include "terminal_width.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace thermorig::app {

std::size_t terminal_width() {
  winsize size{};
  const bool known = ioctl(fileno(stdout), TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  if (known) return size.ws_col;
  const char* wanted = std::getenv("COLUMNS");
  const long columns = wanted == nullptr ? 0 : std::strtol(wanted, nullptr, 10);
  return columns >= 40 && columns <= 10'000 ? static_cast<std::size_t>(columns) : 80;
}

namespace {

/// Of text in UTF-8, a column a character.
std::size_t columns_of(std::string_view text) {
  return static_cast<std::size_t>(
      std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

/// What stands behind a label: a word with a colon, or some words and two blanks.
std::size_t hanging_indent(std::string_view line) {
  constexpr std::size_t deepest = 24;
  const std::size_t begin = std::min(line.find_first_not_of(' '), line.size());
  const std::size_t colon = std::min(line.find(": ", begin), line.size());
  const bool is_word = line.substr(begin, colon - begin).find(' ') == std::string_view::npos;
  const std::size_t end = is_word ? colon + 1 : line.find("  ", begin);
  const std::size_t next = line.find_first_not_of(' ', std::min(end, line.size()));
  return next <= deepest ? next : begin + 2;
}

constexpr std::size_t longest_unit = 10;  // columns of "deg/s^2,"; a longer word with a '/' is a path

std::string folded_line(std::string_view line, std::size_t width) {
  if (columns_of(line) <= width || line.find_first_of("\x1b\r") != std::string_view::npos)
    return std::string(line);
  const std::string indent(hanging_indent(line), ' ');
  std::string done, current;
  std::size_t breakable = 0;  // columns, but for paths
  for (std::size_t at = 0; at < line.size();) {
    const std::size_t begin = std::min(line.find_first_not_of(' ', at), line.size());
    if (begin == line.size()) {  // blanks at the end make no line
      if (columns_of(current) + (begin - at) <= width) current += line.substr(at);
      break;
    }
    const std::size_t end = std::min(line.find(' ', begin), line.size());
    const std::string_view word = line.substr(at, end - at);  // with the blanks before it
    const bool is_path = word.find('/') != std::string_view::npos && end - begin > longest_unit;
    breakable += is_path ? begin - at : columns_of(word);
    if (!done.empty() || !current.empty()) {
      const bool is_full = columns_of(current) + columns_of(word) > width;
      if (is_full && current.size() > indent.size()) {
        done += current + "\n";
        current = indent + std::string(line.substr(begin, end - begin));
        at = end;
        continue;
      }
    }
    current += word;
    at = end;
  }
  return breakable <= width ? std::string(line) : done + current;
}

}  // namespace

std::string folded(std::string_view text, std::size_t width) {
  std::string out;
  while (true) {
    const std::size_t end = text.find('\n');
    out += folded_line(text.substr(0, end), width);
    if (end == std::string_view::npos) return out;
    out += '\n';
    text.remove_prefix(end + 1);
  }
}

std::string drawn_over(std::string_view line, std::size_t width) {
  return "\r\x1b[K" + std::string(line.substr(0, width - 1));  // a full line would wrap
}

}  // namespace thermorig::app
