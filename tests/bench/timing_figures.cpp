// SPDX-License-Identifier: MIT
#include "timing_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iterator>

namespace thermorig::bench {
namespace {

std::string limit_text(const Figure& figure) {
  return figure.at_most ? fmt::format("<= {:g}", *figure.at_most) : fmt::format(">= {:g}", *figure.at_least);
}

std::string cell_text(const Figure& figure) {
  const std::string value = figure.value ? fmt::format("{:.3g}", *figure.value) : "-";
  if (!has_limit(figure)) return value;
  return fmt::format("{} ({}{})", value, limit_text(figure), is_met(figure) ? "" : ", **not met**");
}

std::string column_text(const Figure& figure) {
  return figure.unit.empty() ? figure.column : figure.column + ", " + figure.unit;
}

/// Values in the order in which they come first, one of each.
template <typename Text>
std::vector<std::string> distinct(const std::vector<Figure>& figures, Text text) {
  std::vector<std::string> found;
  for (const Figure& figure : figures)
    if (std::find(found.begin(), found.end(), text(figure)) == found.end()) found.push_back(text(figure));
  return found;
}

void print_row(const std::vector<Figure>& section, const std::string& row,
               const std::vector<std::string>& columns) {
  std::string line = fmt::format("| {} |", row);
  std::string notes;
  for (const std::string& column : columns) {
    const auto figure = std::find_if(section.begin(), section.end(), [&](const Figure& one) {
      return one.row == row && column_text(one) == column;
    });
    line += fmt::format(" {} |", figure == section.end() ? "" : cell_text(*figure));
    if (figure != section.end() && !figure->note.empty()) notes += (notes.empty() ? "" : "; ") + figure->note;
  }
  fmt::print("{} {} |\n", line, notes);
}

void print_section(const std::string& name, const std::vector<Figure>& section) {
  const auto columns = distinct(section, column_text);
  fmt::print("\n### {}\n\n| |", name);
  for (const std::string& column : columns) fmt::print(" {} |", column);
  fmt::print(" |\n| --- |");
  for (std::size_t i = 0; i < columns.size(); ++i) fmt::print(" --- |");
  fmt::print(" --- |\n");
  for (const std::string& row : distinct(section, [](const Figure& figure) { return figure.row; }))
    print_row(section, row, columns);
}

std::string json_number(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? fmt::format("{:.6g}", *value) : "null";
}

}  // namespace

bool has_limit(const Figure& figure) {
  return figure.at_most || figure.at_least;
}

bool is_met(const Figure& figure) {
  if (!figure.value) return false;
  return (!figure.at_most || *figure.value <= *figure.at_most) &&
         (!figure.at_least || *figure.value >= *figure.at_least);
}

void drop_limits(std::vector<Figure>& figures) {
  for (Figure& figure : figures) figure.at_most = figure.at_least = std::nullopt;
}

void print_text(const std::vector<Figure>& figures) {
  for (const std::string& name : distinct(figures, [](const Figure& figure) { return figure.section; })) {
    std::vector<Figure> section;
    std::copy_if(figures.begin(), figures.end(), std::back_inserter(section),
                 [&](const Figure& figure) { return figure.section == name; });
    print_section(name, section);
  }
  const auto limited = std::count_if(figures.begin(), figures.end(), has_limit);
  const auto met = std::count_if(figures.begin(), figures.end(),
                                 [](const Figure& figure) { return has_limit(figure) && is_met(figure); });
  fmt::print("\n{} of {} figures that have something to meet meet it.\n", met, limited);
}

void print_json(const std::vector<Figure>& figures) {
  fmt::print("{{\n");
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const Figure& figure = figures[i];
    const std::string met = has_limit(figure) ? (is_met(figure) ? "true" : "false") : "null";
    fmt::print(
        "  \"{}\": {{\"value\": {}, \"unit\": \"{}\", \"at_most\": {}, \"at_least\": {}, \"met\": {}}}{}\n",
        figure.key, json_number(figure.value), figure.unit, json_number(figure.at_most),
        json_number(figure.at_least), met, i + 1 < figures.size() ? "," : "");
  }
  fmt::print("}}\n");
}

double rms(const std::vector<float>& values) {
  double squares = 0.0;
  for (const float value : values) squares += static_cast<double>(value) * static_cast<double>(value);
  return values.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(values.size()));
}

double size_percentile(std::vector<float>& values, double share) {
  if (values.empty()) return 0.0;
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  const auto smaller = [](float a, float b) { return std::abs(a) < std::abs(b); };
  std::nth_element(values.begin(), values.begin() + at, values.end(), smaller);
  return std::abs(static_cast<double>(values[static_cast<std::size_t>(at)]));
}

std::optional<TableOptions> table_options(int count, char** arguments, std::string_view usage,
                                          std::uint64_t first_seed) {
  TableOptions options{.first_seed = first_seed};
  for (int i = 1; i < count; ++i) {
    const std::string word = arguments[i];
    const char* const value = i + 1 < count ? arguments[i + 1] : nullptr;
    const bool is_flag = usage.find("[" + word + "]") != std::string_view::npos;
    const bool is_option = value != nullptr && usage.find("[" + word + " ") != std::string_view::npos;
    if (is_flag && word == "--json")
      options.json = true;
    else if (is_flag && word == "--quick")
      options.quick = true;
    else if (is_option && word == "--first-seed")
      options.first_seed = std::strtoull(value, nullptr, 10);
    else if (is_option && word == "--only")
      options.only = value;
    else if (is_option && word == "--world")
      options.world = value;
    else {
      fmt::print(stderr, "usage: {}\n", usage);
      return std::nullopt;
    }
    if (is_option) ++i;
  }
  return options;
}

}  // namespace thermorig::bench
