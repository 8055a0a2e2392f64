// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace thermorig::sensors {

/// A line of text as it stands in a stream.
struct RawLine {
  std::string_view text;  // without its end
  std::size_t bytes = 0;  // with it
};

/// The line that `bytes` begin with; none if it has no end yet. A line ends with LF, CR LF or CR; a CR at the
/// very end waits for what follows, unless `ended`.
std::optional<RawLine> first_line(std::span<const std::uint8_t> bytes, bool ended);

/// Calls `use` with every line of `bytes` that has an end.
template <typename Use>
void for_each_line(std::span<const std::uint8_t> bytes, Use use) {
  while (!bytes.empty()) {
    const std::optional<RawLine> line = first_line(bytes, true);
    if (!line) return;
    use(*line);
    bytes = bytes.subspan(line->bytes);
  }
}

/// A line without a byte order mark in front and without terminal codes (colours: ESC [ ... m). `room` is
/// used where codes stand among other characters, and is what the result may lie in.
std::string_view plain_text(std::string_view line, std::string& room);

bool is_blank(std::string_view line);

/// No control characters other than the tab; characters beyond ASCII in any encoding may be.
bool is_text(std::string_view line);

/// "12:15:02.00", "2025-01-01", "12/06/2020", "[12:15:02]".
bool is_clock(std::string_view token);

/// A line behind the clock text that a terminal program puts in front: "12:34:56.789 -> ".
std::string_view behind_clock(std::string_view line);

/// One column of a line.
struct TextField {
  std::string_view text;   // all of it: "gx:1.5"
  std::string_view name;   // "gx" of "gx:1.5" or "gx=1.5"; else empty
  std::string_view value;  // "1.5"
};

/// The fields of a line, one after the other. They lie between separators: one comma or semicolon with blanks
/// around it, or blanks alone. So "1,,2" has an empty field in the middle; a separator at the end opens no
/// further field.
class Fields {
 public:
  explicit Fields(std::string_view line);
  std::optional<TextField> next();

 private:
  std::string_view rest_;
};

std::vector<TextField> split_fields(std::string_view line);

/// The whole text as a number, which may be infinite or NaN; none if it is no number. Brackets and quotes
/// around it, a unit or a check sum ("*5A") right behind it are no part of it.
std::optional<double> read_number(std::string_view text);

/// Of a text that read_number() reads: its digits.
std::string_view digits_of(std::string_view text);

/// A sign and nothing else.
bool is_sign(std::string_view text);

/// "gy: - 0.17": a sign that stands apart from its number, which would be read without it.
bool has_stray_sign(std::string_view line);

/// "0,35;1,20;-3,50", "gx: 1,362 mdps": commas within numbers, where something else separates these.
bool has_decimal_commas(std::string_view line);

}  // namespace thermorig::sensors
