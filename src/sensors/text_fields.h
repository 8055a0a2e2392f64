// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
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

bool is_blank(std::string_view line);

/// ASCII without control characters other than the tab.
bool is_printable(std::string_view line);

/// One column of a line.
struct TextField {
  std::string_view name;   // "gx" of "gx:1.5" or "gx=1.5"; else empty
  std::string_view value;  // "1.5"
};

/// Fields lie between separators: one comma or semicolon with blanks around it, or blanks alone. So "1,,2"
/// has an empty field in the middle; a separator at the end opens no further field.
std::vector<TextField> split_fields(std::string_view line);

/// The whole text as a number, which may be infinite or NaN; none if it is no number.
std::optional<double> read_number(std::string_view text);

}  // namespace thermorig::sensors
