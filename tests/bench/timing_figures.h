// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace thermorig::bench {

/// One number of the table, at a row and a column of its section.
struct Figure {
  std::string section;
  std::string row;
  std::string column;
  std::string key;              // snake_case, unique
  std::string unit;             // "ms", "%", ""
  std::optional<double> value;  // none: could not be measured
  std::optional<double> at_most;
  std::optional<double> at_least;
  std::string note;  // of the row: how many took part, why there is no value
};

bool has_limit(const Figure& figure);
bool is_met(const Figure& figure);

/// What must be met is asked of the honest world alone.
void drop_limits(std::vector<Figure>& figures);

/// Markdown tables, one a section; what is not met says so.
void print_text(const std::vector<Figure>& figures);

/// One object: key -> {value, unit, at_most, at_least, met}.
void print_json(const std::vector<Figure>& figures);

double rms(const std::vector<float>& values);

/// The size below which `share` of the values lie, whatever their sign; they are put in another order.
double size_percentile(std::vector<float>& values, double share);

/// What a table is asked for on the command line.
struct TableOptions {
  bool json = false, quick = false;
  std::uint64_t first_seed = 1;
  std::string only;   // of the rows: those whose name has it
  std::string world;  // of the simulated rigs; empty: the table's own
};

/// The words that stand in `usage`: "name [--json] [--quick] [--first-seed N] [--only TEXT]
/// [--world NAME]". At another one nothing, and the usage on standard error. `first_seed`: where none is
/// named.
std::optional<TableOptions> table_options(int count, char** arguments, std::string_view usage,
                                          std::uint64_t first_seed = 1);

}  // namespace thermorig::bench
