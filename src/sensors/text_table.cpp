// SPDX-License-Identifier: MIT
#include "text_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "text_fields.h"
#include "thermorig/sensors/text_format.h"

namespace thermorig::sensors {

namespace {

double finite_number(std::string_view text) {
  const double number = read_number(text).value_or(std::numeric_limits<double>::quiet_NaN());
  return std::isfinite(number) ? number : std::numeric_limits<double>::quiet_NaN();
}

/// What stands before the first number, without the blanks between.
std::string leading_text(std::string_view line) {
  for (const TextField& field : split_fields(line)) {
    if (std::isnan(finite_number(field.value))) continue;
    const char* first = field.name.empty() ? field.value.data() : field.name.data();
    std::string_view leading = line.substr(0, static_cast<std::size_t>(first - line.data()));
    leading = leading.substr(0, leading.find_last_not_of(" \t") + 1);
    return std::string(leading);
  }
  return std::string(line);
}

/// Collects lines by format.
class Formats {
 public:
  void add(const RawLine& line) {
    if (is_blank(line.text) || !is_printable(line.text)) return;
    const std::string prefix = leading_text(line.text);
    if (prefix == line.text) return add_header(line.text);
    const auto fields = split_fields(line.text.substr(prefix.size()));
    TextTable& table = tables_[{prefix, fields.size()}];
    if (table.rows.empty()) table.sample_line = line.text;
    table.prefix = prefix;
    table.bytes += line.bytes;
    table.names.clear();
    auto& row = table.rows.emplace_back();
    for (const TextField& field : fields) {
      row.push_back(finite_number(field.value));
      table.names.emplace_back(field.name);
    }
  }

  TextTable most_frequent() const {
    TextTable best;
    for (const auto& [format, table] : tables_)
      if (weight(table) > weight(best)) best = table;
    const auto header = headers_.find(best.names.size());
    const bool named =
        std::any_of(best.names.begin(), best.names.end(), [](const auto& n) { return !n.empty(); });
    if (!named && header != headers_.end()) best.names = header->second;
    return best;
  }

 private:
  void add_header(std::string_view line) {
    std::vector<std::string> names;
    for (const TextField& field : split_fields(line)) names.emplace_back(field.value);
    headers_.emplace(names.size(), std::move(names));
  }

  /// A device that prints lines of acceleration and of rates by turns marks the latter.
  static std::size_t weight(const TextTable& table) {
    const bool marked = table.prefix.starts_with('g') || table.prefix.starts_with('G');
    return table.rows.size() * (marked ? 2 : 1);
  }

  std::map<std::pair<std::string, std::size_t>, TextTable> tables_;  // by prefix and number of columns
  std::map<std::size_t, std::vector<std::string>> headers_;          // lines of names, by their number
};

}  // namespace

std::vector<std::size_t> TextTable::number_columns() const {
  std::vector<std::size_t> columns;
  for (std::size_t column = 0; !rows.empty() && column < rows.front().size(); ++column)
    if (std::none_of(rows.begin(), rows.end(), [&](const auto& row) { return std::isnan(row[column]); }))
      columns.push_back(column);
  return columns;
}

std::optional<CountedLine> first_text_line(std::span<const std::uint8_t> bytes) {
  while (const auto line = first_line(bytes, true)) {
    if (!is_blank(line->text) && is_printable(line->text))
      return CountedLine{std::string(line->text), split_fields(line->text).size()};
    bytes = bytes.subspan(line->bytes);
  }
  return std::nullopt;
}

TextTable most_frequent_table(std::span<const std::uint8_t> bytes, StreamStart start) {
  Formats formats;
  bool whole = start == StreamStart::at_line_start;  // else the first line may be the tail of one
  while (const auto line = first_line(bytes, true)) {
    if (whole) formats.add(*line);
    whole = true;
    bytes = bytes.subspan(line->bytes);
  }
  return formats.most_frequent();
}

}  // namespace thermorig::sensors
