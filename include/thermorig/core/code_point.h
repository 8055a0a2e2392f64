// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace thermorig {

/// The first and the last of a run of Unicode code points.
struct CodePoints {
  char32_t first = 0;
  char32_t last = 0;
};

template <std::size_t count>
constexpr bool is_within(const CodePoints (&spans)[count], char32_t code_point) {
  for (const CodePoints& span : spans)
    if (code_point >= span.first && code_point <= span.last) return true;
  return false;
}

/// C0, delete and C1: they move a terminal's cursor, and begin its escape sequences.
constexpr bool is_control(char32_t code_point) {
  return code_point < 0x20 || (code_point >= 0x7f && code_point < 0xa0);
}

/// Line and paragraph separator: whatever shows a text may begin a new line there.
constexpr bool separates_lines(char32_t code_point) {
  return code_point == 0x2028 || code_point == 0x2029;
}

/// Marks, embeddings, overrides and isolates of the bidirectional algorithm (Unicode's Bidi_Control): what
/// stands after them is drawn in another order than it is stored.
constexpr bool changes_direction(char32_t code_point) {
  constexpr CodePoints controls[] = {{0x061c, 0x061c}, {0x200e, 0x200f}, {0x202a, 0x202e}, {0x2066, 0x2069}};
  return is_within(controls, code_point);
}

/// Nothing is drawn for it, so that two texts that differ look the same: Unicode's
/// Default_Ignorable_Code_Point, which holds those that change the direction, and the marks of annotations.
/// Not U+FE0E and U+FE0F: they say whether the character before them is drawn as text or as an emoji, and
/// every keyboard that has emojis sends them. No spaces: a blank can be seen.
constexpr bool is_invisible(char32_t code_point) {
  constexpr CodePoints ignorable[] = {
      {0x00ad, 0x00ad},     // soft hyphen
      {0x034f, 0x034f},     // combining grapheme joiner
      {0x061c, 0x061c},     // Arabic letter mark
      {0x115f, 0x1160},     // Hangul fillers
      {0x17b4, 0x17b5},     // Khmer inherent vowels
      {0x180b, 0x180f},     // Mongolian variation selectors and vowel separator
      {0x200b, 0x200f},     // zero-width space and joiners, direction marks
      {0x202a, 0x202e},     // direction embeddings and overrides
      {0x2060, 0x206f},     // word joiner, invisible operators, direction isolates
      {0x3164, 0x3164},     // Hangul filler
      {0xfe00, 0xfe0d},     // variation selectors 1 to 14
      {0xfeff, 0xfeff},     // byte order mark
      {0xffa0, 0xffa0},     // halfwidth Hangul filler
      {0xfff0, 0xfffb},     // unassigned; marks of annotations
      {0x1bca0, 0x1bca3},   // shorthand format controls
      {0x1d173, 0x1d17a},   // musical format controls
      {0xe0000, 0xe0fff}};  // tags, variation selectors 17 to 256
  return is_within(ignorable, code_point);
}

/// May it stand in one line of text that others wrote? Nothing that steers a terminal, breaks the line,
/// changes its order or cannot be seen.
constexpr bool is_plain(char32_t code_point) {
  return !is_control(code_point) && !separates_lines(code_point) && !changes_direction(code_point) &&
         !is_invisible(code_point);
}

/// A character and how many bytes of UTF-8 it takes.
struct Character {
  char32_t code_point = 0;
  std::size_t bytes = 1;
};

/// What `text`, which is not empty, begins with; nothing if that is not UTF-8 (RFC 3629).
std::optional<Character> first_character(std::string_view text);

bool is_utf8(std::string_view text);

}  // namespace thermorig
