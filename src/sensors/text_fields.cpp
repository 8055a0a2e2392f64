// SPDX-License-Identifier: MIT
#include "text_fields.h"

#include <algorithm>
#include <charconv>

#include "text_words.h"

namespace thermorig::sensors {

namespace {

constexpr std::string_view blanks = " \t\v\f";
constexpr std::string_view separators = ",; \t\v\f";
constexpr std::string_view opening = "[{(\"'";
constexpr std::string_view before_names = "[{(\"'#$>";  // ">gx:1.5": Teleplot's
constexpr std::string_view closing = "]})\"'";
constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
constexpr char escape = '\x1b';

std::string_view without_leading(std::string_view text, std::string_view characters) {
  text.remove_prefix(std::min(text.find_first_not_of(characters), text.size()));
  return text;
}

/// What most fields are: nothing stands in front of the number.
bool begins_with_number(std::string_view text) {
  return !text.empty() && (is_digit(text[0]) || text[0] == '-');
}

/// A name begins with a letter, so that "12:30" stays what it is; it needs a value right behind it.
TextField field_of(std::string_view text) {
  if (begins_with_number(text)) return {text, {}, text};
  const std::string_view bare = without_leading(text, before_names);
  const std::size_t mark = bare.find_last_of(":=");
  if (mark == std::string_view::npos || mark + 1 == bare.size() || !is_letter(bare[0]))
    return {text, {}, text};
  return {text, bare.substr(0, mark), bare.substr(mark + 1)};
}

/// What may stand right behind a number's digits: brackets, a unit, a check sum in hexadecimal.
bool is_tail(std::string_view text) {
  text = without_leading(text, closing);
  text.remove_prefix(unit_length(text));
  text = without_leading(text, closing);
  if (text.empty()) return true;
  return text[0] == '*' && (text.size() == 3 || text.size() == 5) &&
         text.find_first_not_of("0123456789abcdefABCDEF", 1) == text.npos;
}

struct Digits {
  std::string_view text;  // empty: none
  double number = 0.0;
};

Digits digits_in(std::string_view text) {
  if (!begins_with_number(text)) text = without_leading(text, opening);
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  Digits digits;
  const char* const end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, digits.number);
  if (result.ec != std::errc() || (result.ptr != end && !is_tail({result.ptr, end}))) return {};
  digits.text = {text.data(), result.ptr};
  return digits;
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

std::string_view plain_text(std::string_view line, std::string& room) {
  while (line.starts_with('\0')) line.remove_prefix(1);  // the end of a C string, sent with the line before
  if (line.starts_with(byte_order_mark)) line.remove_prefix(byte_order_mark.size());
  if (line.find(escape) == line.npos) return line;
  room.clear();
  for (std::size_t at = 0; at < line.size(); ++at) {
    if (line[at] != escape || at + 1 >= line.size() || line[at + 1] != '[') {
      room += line[at];
      continue;
    }
    at += 2;
    while (at < line.size() && !(line[at] >= '@' && line[at] <= '~')) ++at;  // ECMA-48: its final byte
  }
  return room;
}

bool is_blank(std::string_view line) {
  return line.find_first_not_of(blanks) == std::string_view::npos;
}

bool is_text(std::string_view line) {
  return std::all_of(line.begin(), line.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte == '\t' || (byte >= ' ' && byte != 0x7F);
  });
}

bool is_clock(std::string_view token) {
  token = without_leading(token, opening);
  if (token.size() < 4 || !is_digit(token[0])) return false;
  if (token.find_first_not_of("0123456789:-/.TZ+]),") != token.npos) return false;
  return token.find(':') != token.npos || std::count(token.begin(), token.end(), '/') == 2 ||
         std::count(token.begin() + 1, token.end(), '-') == 2;
}

std::string_view behind_clock(std::string_view line) {
  bool is_behind = false;
  std::string_view rest = line;
  for (;;) {
    rest = without_leading(rest, separators);
    const std::string_view token = rest.substr(0, std::min(rest.find_first_of(separators), rest.size()));
    const bool is_arrow = is_behind && !token.empty() && token.find_first_not_of("->|:") == token.npos;
    if (!is_clock(token) && !is_arrow) return is_behind ? rest : line;
    is_behind = true;
    rest.remove_prefix(token.size());
  }
}

Fields::Fields(std::string_view line) : rest_(without_leading(line, blanks)) {}

std::optional<TextField> Fields::next() {
  if (rest_.empty()) return std::nullopt;
  const std::size_t size = std::min(rest_.find_first_of(separators), rest_.size());
  const TextField field = field_of(rest_.substr(0, size));
  rest_ = without_leading(rest_.substr(size), blanks);
  if (!rest_.empty() && (rest_[0] == ',' || rest_[0] == ';'))
    rest_ = without_leading(rest_.substr(1), blanks);
  return field;
}

std::vector<TextField> split_fields(std::string_view line) {
  std::vector<TextField> all;
  Fields fields(line);
  while (const auto field = fields.next()) all.push_back(*field);
  return all;
}

std::optional<double> read_number(std::string_view text) {
  const Digits digits = digits_in(text);
  return digits.text.empty() ? std::nullopt : std::optional(digits.number);
}

std::string_view digits_of(std::string_view text) {
  return digits_in(text).text;
}

bool is_sign(std::string_view text) {
  return text == "-" || text == "+";
}

bool has_stray_sign(std::string_view line) {
  bool behind_sign = false;
  for (Fields fields(line); const auto field = fields.next();) {
    if (behind_sign && begins_with_number(field->value) && read_number(field->value)) return true;
    behind_sign = is_sign(field->value);
  }
  return false;
}

/// "1,362" behind a name and before a blank: a comma that groups digits.
bool has_grouped_digits(std::string_view cell) {
  const TextField field = field_of(cell);
  const std::size_t comma = field.value.find(',');
  return !field.name.empty() && comma != field.value.npos && comma >= 1 && field.value.size() == comma + 4 &&
         field.value.find_first_not_of("-0123456789,") == field.value.npos;
}

bool has_decimal_commas(std::string_view line) {
  bool has_comma = false, has_other = false;
  for (const char c : line) {
    has_comma |= c == ',';
    has_other |= c == ';' || c == ' ' || c == '\t';
  }
  if (!has_comma || !has_other) return false;
  std::size_t with_comma = 0;
  while (!(line = without_leading(line, "; \t\v\f")).empty()) {
    std::string_view cell = line.substr(0, std::min(line.find_first_of("; \t\v\f"), line.size()));
    line.remove_prefix(cell.size());
    if (has_grouped_digits(cell)) return true;
    const TextField field = field_of(cell);
    cell = field.value.substr(0, field.value.find_last_not_of(',') + 1);
    if (!cell.empty() && (cell[0] == '-' || cell[0] == '+')) cell.remove_prefix(1);
    if (cell.empty() || !is_digit(cell[0])) continue;
    const std::size_t comma = std::min(cell.find(','), cell.size());
    const std::string_view behind = cell.substr(std::min(comma + 1, cell.size()));
    if (cell.find('.') != cell.npos ||
        cell.find_first_not_of("0123456789") != (comma < cell.size() ? comma : cell.npos))
      return false;
    if (comma == cell.size()) continue;
    if (behind.empty() || behind.find_first_not_of("0123456789") != behind.npos) return false;
    ++with_comma;
  }
  return with_comma >= 2;
}

}  // namespace thermorig::sensors
