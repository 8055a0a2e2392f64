// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
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

/// Runs `work(index)` for 0..count - 1 on all cores. Each must write to its own place only.
void for_each_seed(std::size_t count, const std::function<void(std::size_t)>& work);

}  // namespace thermorig::bench
