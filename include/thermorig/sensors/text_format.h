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

/// Numbers without words of so many columns are not of a gyro: a row of a thermal image, or the whole of it,
/// printed as text.
constexpr std::size_t image_line_fields = frame_columns;

/// Of a line without its end; what prints longer ones is no gyro that can be read.
constexpr std::size_t text_line_bytes_max = 4096;

/// What the lines of a text gyro look like, and how they are to be read: by the words on them, where they
/// have some. What no word says is a guess, to be checked by a person.
struct TextFormat {
  TextColumns columns;                   // proposed
  std::string sample_line;               // the first of the lines, without its end
  std::size_t fields = 0;                // its columns behind the prefix
  std::uint64_t lines = 0;               // that look like it
  std::uint64_t bytes = 0;               // in lines of text of any kind
  bool rates_known = false;              // words, or a known sketch, say which columns are the rates
  bool scale_known = false;              // and in which unit
  bool is_counts = false;                // the rates are whole numbers, in no unit that is said
  std::string sketch;                    // whose lines they are (gyro_sketch.h), where their words tell it
  std::string refusal;                   // why rates cannot be read from these lines; else empty
  std::string advice;                    // then: what to try
  std::vector<std::string> assumptions;  // what was concluded from what, a sentence each
  std::vector<std::string> remarks;      // what is to be known of the rates, a sentence each

  /// Nothing of it is a guess.
  bool is_known() const { return refusal.empty() && rates_known && scale_known; }
};

/// What the lines do not say: "which columns are the rates, and in which unit"; empty if they say all.
std::string open_question(const TextFormat& format);

/// The kind of lines that hold rates, by their words: names ("GyroX", "Rotation", "wx"), units ("rad/s",
/// "DPS"), a header, lines that stand above, the marks of known sketches. Without such words: the most
/// frequent kind, of at least two lines with at least three columns of numbers and fewer than
/// image_line_fields in all; then its columns are a guess by their numbers. The device's time is a column
/// that runs like a clock, its unit by its name or the line rate if the bytes took `heard_s` seconds to come.
/// Lines that say that they hold something else (angles, accelerations) give a format with a refusal.
std::optional<TextFormat> guess_text_format(std::span<const std::uint8_t> bytes,
                                            StreamStart start = StreamStart::anywhere, double heard_s = 0.0);

/// A line of text and the number of its columns, as far as separators show them.
struct CountedLine {
  std::string text;
  std::size_t fields = 0;
};

/// Whether nearly all bytes are characters, which those of another protocol or at a wrong baud rate are not.
bool is_readable(std::span<const std::uint8_t> bytes);

/// The first whole line of printable text that is not blank; none if there is no such line.
std::optional<CountedLine> first_text_line(std::span<const std::uint8_t> bytes);

}  // namespace thermorig::sensors
