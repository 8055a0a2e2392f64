// SPDX-License-Identifier: MIT
#include "text.h"

#include <cstdint>

namespace thermorig::model {

namespace {

struct Character {
  std::size_t bytes = 0;  // 0: not UTF-8
  std::uint32_t code = 0;
};

bool is_continuation(char byte) {
  return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80U;
}

/// How many bytes a first byte announces (RFC 3629), 0 if it is none.
std::size_t length_of(unsigned char first) {
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first < 0xE0) return 2;
  if (first >= 0xE0 && first < 0xF0) return 3;
  return first >= 0xF0 && first < 0xF5 ? 4 : 0;
}

bool is_canonical(const Character& character) {
  constexpr std::uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = character.code >= 0xD800 && character.code < 0xE000;
  return character.code >= least[character.bytes] && character.code <= 0x10FFFF && !surrogate;
}

Character first_of(std::string_view text) {
  const auto first = static_cast<unsigned char>(text[0]);
  Character character{length_of(first), first};
  if (character.bytes == 1) return character;
  if (character.bytes == 0 || character.bytes > text.size()) return {};
  character.code = first & (0x7FU >> character.bytes);
  for (std::size_t i = 1; i < character.bytes; ++i) {
    if (!is_continuation(text[i])) return {};
    character.code = character.code << 6U | (static_cast<unsigned char>(text[i]) & 0x3FU);
  }
  return is_canonical(character) ? character : Character{};
}

bool is_control(std::uint32_t code) {
  const auto within = [code](std::uint32_t first, std::uint32_t last) {
    return first <= code && code <= last;
  };
  return code < 0x20 || within(0x7F, 0x9F) || within(0x200E, 0x200F) || within(0x2028, 0x202E) ||
         within(0x2066, 0x2069);
}

bool is_plain(const Character& character) {
  return character.bytes != 0 && !is_control(character.code);
}

}  // namespace

bool is_plain_text(std::string_view text) {
  if (text.size() > text_bytes_max) return false;
  while (!text.empty()) {
    const Character character = first_of(text);
    if (!is_plain(character)) return false;
    text.remove_prefix(character.bytes);
  }
  return true;
}

std::string plain_text(std::string_view text, std::size_t bytes_max) {
  std::string plain;
  while (!text.empty()) {
    const Character character = first_of(text);
    const std::string_view next = is_plain(character) ? text.substr(0, character.bytes) : "?";
    if (plain.size() + next.size() > bytes_max) break;
    plain += next;
    text.remove_prefix(character.bytes == 0 ? 1 : character.bytes);
  }
  return plain;
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t shown_bytes = 60;
  const std::string shown = plain_text(text, shown_bytes);
  return "'" + shown + (shown.size() < text.size() && shown.size() + 4 > shown_bytes ? "..." : "") + "'";
}

}  // namespace thermorig::model
