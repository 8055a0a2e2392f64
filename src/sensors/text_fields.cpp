// SPDX-License-Identifier: MIT
#include "text_fields.h"

#include <algorithm>
#include <charconv>

namespace thermorig::sensors {

namespace {

constexpr std::string_view blanks = " \t\v\f";
constexpr std::string_view separators = ",; \t\v\f";

std::string_view without_leading_blanks(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
  return text;
}

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/// A name begins with a letter, so that "12:30" stays what it is; it needs a value right behind it.
TextField field_of(std::string_view text) {
  const std::size_t mark = text.find_last_of(":=");
  if (mark == std::string_view::npos || mark + 1 == text.size() || !is_letter(text[0])) return {{}, text};
  return {text.substr(0, mark), text.substr(mark + 1)};
}

}  // namespace

std::optional<RawLine> first_line(std::span<const std::uint8_t> bytes, bool ended) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::size_t size = text.find_first_of("\r\n");
  if (size == std::string_view::npos) return std::nullopt;
  if (text[size] == '\n') return RawLine{text.substr(0, size), size + 1};
  if (size + 1 == text.size())
    return ended ? std::optional(RawLine{text.substr(0, size), size + 1}) : std::nullopt;
  return RawLine{text.substr(0, size), size + (text[size + 1] == '\n' ? 2 : 1)};
}

bool is_blank(std::string_view line) {
  return line.find_first_not_of(blanks) == std::string_view::npos;
}

bool is_printable(std::string_view line) {
  return std::all_of(line.begin(), line.end(), [](char c) { return c == '\t' || (c >= ' ' && c <= '~'); });
}

std::vector<TextField> split_fields(std::string_view line) {
  std::vector<TextField> fields;
  line = without_leading_blanks(line);
  while (!line.empty()) {
    const std::size_t size = std::min(line.find_first_of(separators), line.size());
    fields.push_back(field_of(line.substr(0, size)));
    line = without_leading_blanks(line.substr(size));
    if (!line.empty() && (line[0] == ',' || line[0] == ';')) line = without_leading_blanks(line.substr(1));
  }
  return fields;
}

std::optional<double> read_number(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  double number = 0.0;
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, number);
  if (result.ec != std::errc() || result.ptr != end) return std::nullopt;
  return number;
}

}  // namespace thermorig::sensors
