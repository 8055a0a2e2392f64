// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "thermorig/sensors/scanner.h"

namespace thermorig::sensors {

/// The lines of a stream that have one format, as a table of numbers.
struct TextTable {
  std::string prefix;                               // what they all begin with, before the first number
  std::string sample_line;                          // the first of them
  std::vector<std::vector<double>> rows;            // NaN where a column is no number
  std::vector<std::string> names;                   // of the columns, empty where they have none
  std::uint64_t bytes = 0;                          // in these lines, with their ends
  std::vector<std::size_t> number_columns() const;  // those that are numbers in every row
};

/// The most frequent format among the whole lines of `bytes`; no rows if there is no line of numbers.
TextTable most_frequent_table(std::span<const std::uint8_t> bytes, StreamStart start);

}  // namespace thermorig::sensors
