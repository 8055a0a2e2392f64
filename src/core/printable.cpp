// SPDX-License-Identifier: MIT
#include "thermorig/core/printable.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

namespace thermorig {

namespace {

struct Range {
  char32_t first, last;
};

// Unicode 15: the control characters, and what has the property Default_Ignorable_Code_Point or is of the
// category Cf (format), Zl or Zp (line and paragraph separators).
constexpr std::array<Range, 28> unseen{
    {{0x00, 0x1F},       {0x7F, 0x9F},       {0xAD, 0xAD},          {0x34F, 0x34F},     {0x600, 0x605},
     {0x61C, 0x61C},     {0x6DD, 0x6DD},     {0x70F, 0x70F},        {0x890, 0x891},     {0x8E2, 0x8E2},
     {0x115F, 0x1160},   {0x17B4, 0x17B5},   {0x180B, 0x180F},      {0x200B, 0x200F},   {0x2028, 0x202E},
     {0x2060, 0x206F},   {0x3164, 0x3164},   {0xFE00, 0xFE0F},      {0xFEFF, 0xFEFF},   {0xFFA0, 0xFFA0},
     {0xFFF0, 0xFFFB},   {0x110BD, 0x110BD}, {0x110CD, 0x110CD},    {0x13430, 0x1343F}, {0x1BCA0, 0x1BCA3},
     {0x1D173, 0x1D17A}, {0xE0000, 0xE0FFF}, {0x110000, 0xFFFFFFFF}}};

/// A character and how many bytes it takes.
struct Decoded {
  char32_t character = 0;
  std::size_t bytes = 1;
};

/// What `text`, which is not empty, begins with; nothing if that is not UTF-8 (RFC 3629).
std::optional<Decoded> decode(std::string_view text) {
  const auto byte = [&](std::size_t at) { return static_cast<std::uint8_t>(text[at]); };
  if (byte(0) < 0x80) return Decoded{byte(0), 1};
  if (byte(0) < 0xC2 || byte(0) > 0xF4) return std::nullopt;
  const std::size_t bytes = byte(0) < 0xE0 ? 2 : byte(0) < 0xF0 ? 3 : 4;
  if (text.size() < bytes) return std::nullopt;
  char32_t character = byte(0) & (0x7FU >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xC0U) != 0x80) return std::nullopt;
    character = (character << 6U) | (byte(i) & 0x3FU);
  }
  constexpr std::array<char32_t, 5> least{0, 0, 0x80, 0x800, 0x10000};
  const bool is_surrogate = character >= 0xD800 && character <= 0xDFFF;
  if (character < least[bytes] || character > 0x10FFFF || is_surrogate) return std::nullopt;
  return Decoded{character, bytes};
}

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

bool is_visible(char32_t character) {
  const auto* const range = std::find_if(unseen.begin(), unseen.end(),
                                         [&](const Range& candidate) { return character <= candidate.last; });
  return character < range->first;
}

std::string printable(std::string_view text) {
  std::string shown;
  while (!text.empty()) {
    const auto decoded = decode(text);
    const std::size_t bytes = decoded ? decoded->bytes : 1;
    if (!decoded)
      shown += "\\x" + hexadecimal(static_cast<std::uint8_t>(text.front()));
    else if (is_visible(decoded->character))
      shown += text.substr(0, bytes);
    else
      shown += name_of(decoded->character);
    text.remove_prefix(bytes);
  }
  return shown;
}

}  // namespace thermorig
