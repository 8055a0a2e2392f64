// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "text_words.h"
#include "thermorig/sensors/scanner.h"

namespace thermorig::sensors {

/// One column of the lines of one kind.
struct TextColumn {
  std::string name;          // the words before it, or those of the header
  Meaning meaning;           // what they say
  bool is_number = true;     // in every row
  std::size_t decimals = 0;  // most digits behind the point
};

/// The lines of a stream that are of one kind: with the same words before the first number, and as many
/// columns.
struct TextTable {
  std::string prefix;                     // what they all begin with, before the first number
  std::string sample_line;                // the first of them, without colours
  std::vector<TextColumn> columns;        // behind the prefix
  std::vector<std::vector<double>> rows;  // NaN where a column is no number

  std::vector<std::size_t> number_columns() const;  // those that are numbers in every row
};

/// The lines of a stream.
struct TextPage {
  std::vector<TextTable> tables;      // by kind; none has no row
  std::vector<std::string> headings;  // lines without a number, each once
  std::size_t heading_lines = 0;      // how many there are
  std::size_t rows = 0;
  std::size_t lines = 0;  // of text, that are not blank
  std::size_t with_decimal_commas = 0;
  std::size_t with_stray_signs = 0;  // "gy: - 0.17"
  std::size_t with_sums = 0;         // that end with "*5A"
  std::size_t with_right_sums = 0;
  std::size_t with_minus_signs = 0;  // U+2212 in front of a digit
  bool headers_differ = false;       // two of them name the same columns in other ways
  std::size_t with_hex = 0;          // three numbers or more: "0x1F"
  std::uint64_t bytes = 0;           // in lines of text, with their ends
};

TextPage read_page(std::span<const std::uint8_t> bytes, StreamStart start);

}  // namespace thermorig::sensors
