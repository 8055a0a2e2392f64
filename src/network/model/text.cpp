// SPDX-License-Identifier: MIT
#include "text.h"

#include <optional>

#include "thermorig/core/code_point.h"

namespace thermorig::model {

namespace {

bool is_plain(const std::optional<Character>& character) {
  return character && !is_control(character->code_point) && !separates_lines(character->code_point) &&
         !changes_direction(character->code_point);
}

}  // namespace

bool is_plain_text(std::string_view text) {
  if (text.size() > text_bytes_max) return false;
  while (!text.empty()) {
    const std::optional<Character> character = first_character(text);
    if (!is_plain(character)) return false;
    text.remove_prefix(character->bytes);
  }
  return true;
}

std::string plain_text(std::string_view text, std::size_t bytes_max) {
  std::string plain;
  while (!text.empty()) {
    const std::optional<Character> character = first_character(text);
    const std::string_view next = is_plain(character) ? text.substr(0, character->bytes) : "?";
    if (plain.size() + next.size() > bytes_max) break;
    plain += next;
    text.remove_prefix(character ? character->bytes : 1);
  }
  return plain;
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t shown_bytes = 60;
  const std::string shown = plain_text(text, shown_bytes);
  return "'" + shown + (shown.size() < text.size() && shown.size() + 4 > shown_bytes ? "..." : "") + "'";
}

}  // namespace thermorig::model
