// SPDX-License-Identifier: MIT
#include "thermorig/core/printable.h"

#include <cstdint>

#include "thermorig/core/code_point.h"
#include "thermorig/core/count_text.h"

namespace thermorig {

namespace {

/// Two digits or more.
std::string hexadecimal(std::uint32_t number) {
  std::string digits;
  for (; number > 0 || digits.size() < 2; number >>= 4U)
    digits.insert(digits.begin(), "0123456789ABCDEF"[number & 0xFU]);
  return digits;
}

std::string name_of(char32_t character) {
  if (character == '\n') return "\\n";
  if (character == '\t') return "\\t";
  if (character == '\r') return "\\r";
  return "\\u{" + hexadecimal(character) + "}";
}

}  // namespace

std::string count_text(std::uint64_t count) {
  std::string text = std::to_string(count);
  for (std::size_t at = text.size(); at > 3;) text.insert(at -= 3, 1, ',');
  return text;
}

std::string printable(std::string_view text) {
  std::string shown;
  while (!text.empty()) {
    const auto character = first_character(text);
    const std::size_t bytes = character ? character->bytes : 1;
    if (!character)
      shown += "\\x" + hexadecimal(static_cast<std::uint8_t>(text.front()));
    else if (is_plain(character->code_point))
      shown += text.substr(0, bytes);
    else
      shown += name_of(character->code_point);
    text.remove_prefix(bytes);
  }
  return shown;
}

std::string shell_word(std::string_view word) {
  constexpr std::string_view plain =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_@%+=:,./-";
  if (!word.empty() && word.find_first_not_of(plain) == std::string_view::npos) return std::string(word);
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

}  // namespace thermorig
