// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "thermorig/core/frame.h"
#include "thermorig/core/profile.h"
#include "thermorig/sensors/scanner.h"

namespace thermorig::sensors {

/// Lines of so many columns are not of a gyro: a row of a thermal image, or the whole of it, printed as text.
constexpr std::size_t image_line_fields = frame_columns;

/// What the lines of a text gyro look like, and how they are probably to be read. Text does not say what its
/// columns are: a guess to be checked by a person.
struct TextFormat {
  TextColumns columns;                   // proposed
  std::string sample_line;               // the first of the lines, without its end
  std::size_t fields = 0;                // its columns behind the prefix
  std::uint64_t lines = 0;               // that look like it
  std::uint64_t bytes = 0;               // in them
  bool rates_known = false;              // by names, or by the order of a known sketch: not just a guess
  std::vector<std::string> assumptions;  // what was concluded from what, a sentence each
};

/// The format that most lines share: at least two of them, with at least three columns of numbers and fewer
/// than image_line_fields in all. From these lines come the prefix, the device's time (a column that runs
/// like a clock, its unit by the line rate if the bytes took `heard_s` seconds to come) and the rates'
/// columns: by their names where a header line or the columns have some, else by their order.
std::optional<TextFormat> guess_text_format(std::span<const std::uint8_t> bytes,
                                            StreamStart start = StreamStart::anywhere, double heard_s = 0.0);

/// A line of text and the number of its columns, as far as separators show them.
struct CountedLine {
  std::string text;
  std::size_t fields = 0;
};

/// The first whole line of printable text that is not blank; none if there is no such line.
std::optional<CountedLine> first_text_line(std::span<const std::uint8_t> bytes);

}  // namespace thermorig::sensors
