// SPDX-License-Identifier: MIT
#include "text_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "text_fields.h"
#include "text_line.h"
#include "thermorig/sensors/text_format.h"

namespace thermorig::sensors {

namespace {

double finite_number(std::string_view text) {
  const double number = read_number(text).value_or(std::numeric_limits<double>::quiet_NaN());
  return std::isfinite(number) ? number : std::numeric_limits<double>::quiet_NaN();
}

std::string_view trimmed(std::string_view text, std::string_view front, std::string_view back) {
  text.remove_prefix(std::min(text.find_first_not_of(front), text.size()));
  return text.substr(0, text.find_last_not_of(back) + 1);
}

/// A name as it stands between numbers: "Gyr (DPS)" of "], Gyr (DPS) [", "gx" of {"gx":.
std::string_view bare_name(std::string_view text) {
  return trimmed(text, " \t,;:=|]})[{\"'", " \t,;:=|[{(\"'");
}

/// What stands before the first number, without the blanks between; all if there is none. The name of a
/// marked line ("#YPR=1.5") stands before it, any other ("gx:1.5") is a column's.
std::string_view leading_text(std::string_view line) {
  Fields fields(line);
  while (const auto field = fields.next())
    if (!std::isnan(finite_number(field->value))) {
      const bool is_mark = field->text[0] == '#' || field->text[0] == '$';
      const char* const end = is_mark ? field->value.data() : field->text.data();
      const std::string_view leading = line.substr(0, static_cast<std::size_t>(end - line.data()));
      return leading.substr(0, leading.find_last_not_of(" \t") + 1);
    }
  return line;
}

bool holds_clock(std::string_view text) {
  Fields fields(text);
  while (const auto field = fields.next())
    if (is_clock(field->text)) return true;
  return false;
}

/// A line as a reader takes it: the prefix by which it knows it, and what the columns are counted in.
struct Parts {
  std::string_view prefix;
  std::string_view columns;
  std::string_view words;  // all of the line that may say what the columns are
};

/// A clock in front is passed over where words follow that tell the line; else its parts are columns.
Parts parts_of(std::string_view line) {
  const std::string_view rest = behind_clock(line);
  const std::string_view leading = leading_text(rest);
  if (is_blank(leading) || holds_clock(leading) || bare_name(leading).empty()) return {{}, line, line};
  return {leading, rest.substr(leading.size()), rest};
}

/// What the words between the numbers say; `behind_last` gets those behind them.
std::vector<TextColumn> columns_of(const Parts& parts, std::string_view& behind_last) {
  std::vector<TextColumn> columns;
  std::vector<std::size_t> numbers;
  WordReader reader;
  const char* behind = parts.words.data();
  const auto words_until = [&](const char* end) {
    return std::string_view(behind, static_cast<std::size_t>(end - behind));
  };
  Fields fields(parts.columns);
  while (const auto field = fields.next()) {
    TextColumn& column = columns.emplace_back();
    const std::string_view digits = digits_of(field->value);
    column.is_number = !digits.empty();
    if (digits.empty()) continue;
    const std::string_view gap = words_until(digits.data());
    if (!numbers.empty() && reader.meanings().back().quantity == Quantity::time) {
      const std::string_view unit = trimmed(gap, " \t", "");
      const std::size_t length = unit_length(unit);  // "time=20 us"
      if (length > 0 && gap.size() > unit.size())
        columns[numbers.back()].name += " " + std::string(unit.substr(0, length));
    }
    reader.words(gap);
    reader.number();
    numbers.push_back(columns.size() - 1);
    column.name = bare_name(words_until(digits.data()));
    if (const std::size_t length = unit_length(column.name);
        numbers.size() > 1 && length < column.name.size())
      column.name = bare_name(std::string_view(column.name).substr(length));  // that of the number before
    behind = digits.data() + digits.size();
  }
  behind_last = words_until(parts.words.data() + parts.words.size());
  reader.words(behind_last);
  reader.end();
  for (std::size_t i = 0; i < numbers.size(); ++i) columns[numbers[i]].meaning = reader.meanings()[i];
  return columns;
}

/// The words of a line as far as they tell its kind: without those that hold digits, such as a clock, and
/// without a check sum.
std::string words_of(const std::vector<TextColumn>& columns, std::string_view behind_last) {
  std::string words;
  const auto add = [&](std::string_view text) {
    Fields fields(text);
    while (const auto field = fields.next())
      if (std::none_of(field->text.begin(), field->text.end(),
                       [](char c) { return is_digit(c) || c == '*'; }))
        words += std::string(field->text) + " ";
    words += "|";
  };
  for (const TextColumn& column : columns) add(column.name);
  add(behind_last);
  return words;
}

std::size_t decimals_of(std::string_view value) {
  const std::string_view digits = digits_of(value);
  const std::size_t point = digits.find('.');
  if (point == digits.npos) return 0;
  return std::min(digits.find_first_not_of("0123456789", point + 1), digits.size()) - point - 1;
}

/// The cells of a line between separators of one kind, without empty ones at its end.
std::vector<std::string_view> cells_of(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  line = line.substr(0, line.find_last_not_of(std::string{separator, ' ', '\t'}) + 1);
  while (!line.empty()) {
    const std::size_t size = std::min(line.find(separator), line.size());
    cells.push_back(line.substr(0, size));
    line.remove_prefix(std::min(size + 1, line.size()));
  }
  return cells;
}

/// A header without the list of units behind it: "gx,gy,gz,ax,ay,az [dps,g]".
struct Header {
  std::string names, units;
};
Header parts_of_header(std::string_view text) {
  const std::size_t end = text.find_last_not_of(" \t");
  const std::size_t begin = end == text.npos ? text.npos : text.find_last_of("[(");
  const bool closes = begin != text.npos && (text[end] == ']' || text[end] == ')');
  const std::string_view inside = closes ? text.substr(begin + 1, end - begin - 1) : std::string_view();
  if (inside.find_first_of(",;|") == inside.npos) return {std::string(text), {}};
  return {std::string(text.substr(0, begin)), std::string(inside)};
}

/// The one unit of rates that a list of units holds: "dps" of "dps,g".
std::string rate_unit_in(std::string_view units) {
  WordReader reader;
  reader.words(units);
  return reader.said_scale_dps() > 0.0 ? reader.said_unit() : "";
}

/// Every cell is a unit or empty, as in the second row of a header.
bool is_row_of_units(const std::vector<std::string_view>& cells) {
  return !cells.empty() && std::all_of(cells.begin(), cells.end(), [](std::string_view cell) {
    const std::string_view unit = trimmed(cell, " \t[(\"'", " \t])\"'");
    return unit.empty() || unit == "-" || unit_length(unit) == unit.size();
  });
}

/// The column that each cell of a line ends with. A cell may hold several ("2025-01-01 06:00:00").
std::vector<std::optional<std::size_t>> columns_in(const std::vector<std::string_view>& cells,
                                                   const TextTable& table) {
  std::vector<std::optional<std::size_t>> holds(cells.size());
  std::size_t cell = 0, column = 0;
  const Parts parts = parts_of(table.sample_line);
  for (Fields fields(parts.columns); const auto field = fields.next(); ++column) {
    while (cell + 1 < cells.size() && field->text.data() >= cells[cell + 1].data()) ++cell;
    if (table.columns[column].is_number) holds[cell] = column;
  }
  return holds;
}

/// Of a header that gives some rates the same unit and others none ("gx [dps],gy,gz") it is that of all.
void share_unit(std::vector<TextColumn>& columns) {
  const TextColumn* with_unit = nullptr;
  for (const TextColumn& column : columns) {
    if (column.meaning.quantity != Quantity::rate || !column.meaning.is_named || column.meaning.unit.empty())
      continue;
    if (with_unit != nullptr && with_unit->meaning.scale_dps != column.meaning.scale_dps) return;
    with_unit = &column;
  }
  if (with_unit == nullptr) return;
  const auto [scale_dps, unit] = std::pair(with_unit->meaning.scale_dps, with_unit->meaning.unit);
  for (TextColumn& column : columns)
    if (column.meaning.quantity == Quantity::rate && column.meaning.is_named && column.meaning.unit.empty()) {
      column.meaning.scale_dps = scale_dps;
      column.meaning.unit = unit;
    }
}

/// The columns of a table with the names of a header, if it has as many cells as the table's lines; a row of
/// units may stand below it.
std::optional<std::vector<TextColumn>> named_columns(const std::string& text, const std::string* units_below,
                                                     const TextTable& table) {
  const Header header = parts_of_header(text);
  std::string shared_unit = rate_unit_in(header.units);
  for (const char separator : {'\t', ',', ';', ' '}) {
    const std::vector<std::string_view> names = cells_of(header.names, separator);
    const std::vector<std::string_view> cells = cells_of(table.sample_line, separator);
    if (names.size() < 3 || names.size() != cells.size() || is_row_of_units(names)) continue;
    std::vector<std::string_view> units;
    if (units_below != nullptr) units = cells_of(*units_below, separator);
    if (!is_row_of_units(units)) units.clear();
    units.resize(names.size());
    if (const auto listed = cells_of(header.units, ',');
        listed.size() == names.size()) {  // "[dps,dps,dps,g]"
      units = listed;
      shared_unit.clear();
    }
    const auto holds = columns_in(cells, table);
    std::vector<TextColumn> columns = table.columns;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (!holds[i]) continue;
      WordReader reader;
      reader.words(std::string(names[i]) + " " + std::string(units[i]));
      reader.number();
      reader.end();
      TextColumn& column = columns[*holds[i]];
      column.name = bare_name(names[i]);
      column.meaning = reader.meanings().front();
      if (!column.meaning.axis_named) column.meaning.axis.reset();
      if (column.meaning.quantity != Quantity::rate || shared_unit.empty()) continue;
      column.meaning.unit = shared_unit;
      column.meaning.scale_dps = scale_of_unit(shared_unit);
    }
    share_unit(columns);
    return columns;
  }
  return std::nullopt;
}

/// Of the same columns.
bool names_other_rates(const std::vector<TextColumn>& a, const std::vector<TextColumn>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Meaning &one = a[i].meaning, &other = b[i].meaning;
    const bool is_rate = one.quantity == Quantity::rate || other.quantity == Quantity::rate;
    if (is_rate &&
        (one.quantity != other.quantity || one.axis != other.axis || one.scale_dps != other.scale_dps))
      return true;
  }
  return false;
}

bool has_words(const TextTable& table) {
  return std::any_of(table.columns.begin(), table.columns.end(), [](const TextColumn& column) {
    const Quantity quantity = column.meaning.quantity;
    return (quantity != Quantity::none && quantity != Quantity::other) || column.meaning.axis_named;
  });
}

bool holds_minus_sign(std::string_view line) {
  constexpr std::string_view minus = "\xE2\x88\x92";
  for (std::size_t at = line.find(minus); at != line.npos; at = line.find(minus, at + 1))
    if (at + minus.size() < line.size() && is_digit(line[at + minus.size()])) return true;
  return false;
}

bool holds_hex(std::string_view line) {
  std::size_t numbers = 0;
  for (Fields fields(line); const auto field = fields.next();) {
    const std::string_view value = trimmed(field->value, "[{(\"'", "]})\"',;");
    numbers += value.size() > 2 && value[0] == '0' && (value[1] == 'x' || value[1] == 'X') &&
               value.find_first_not_of("0123456789abcdefABCDEF", 2) == value.npos;
  }
  return numbers >= 3;
}

/// Collects lines by kind.
class PageReader {
 public:
  void add(const RawLine& line) {
    const std::string_view text = plain_text(line.text, room_);
    if (is_blank(text)) {
      page_.bytes += line.bytes;
      return;
    }
    if (!is_text(text)) return;
    page_.bytes += line.bytes;
    ++page_.lines;
    page_.with_minus_signs += holds_minus_sign(text) ? 1U : 0U;
    page_.with_hex += holds_hex(text) ? 1U : 0U;
    const Parts parts = parts_of(text);
    if (leading_text(parts.columns).size() == parts.columns.size()) return add_heading(text);
    ++page_.rows;
    if (const std::optional<bool> sum = has_right_sum(text)) {
      ++page_.with_sums;
      page_.with_right_sums += *sum ? 1U : 0U;
    }
    page_.with_decimal_commas += has_decimal_commas(text) ? 1U : 0U;
    page_.with_stray_signs += has_stray_sign(text) ? 1U : 0U;
    add_row(text, parts);
  }

  TextPage page() {
    for (TextTable& table : page_.tables) {
      if (has_words(table)) continue;
      const std::string* below = nullptr;
      std::optional<std::vector<TextColumn>> named;
      for (auto header = page_.headings.rbegin(); header != page_.headings.rend(); ++header) {
        const auto columns = named_columns(*header, below, table);
        page_.headers_differ |= named && columns && names_other_rates(*named, *columns);
        if (!named) named = columns;
        below = &*header;
      }
      if (named) table.columns = *named;
    }
    return std::move(page_);
  }

 private:
  void add_heading(std::string_view line) {
    ++page_.heading_lines;
    if (std::find(page_.headings.begin(), page_.headings.end(), line) != page_.headings.end()) return;
    if (page_.headings.size() < headings_max) page_.headings.emplace_back(line);
  }

  void add_row(std::string_view line, const Parts& parts) {
    const std::vector<TextField> fields = split_fields(parts.columns);
    std::string_view behind_last;
    std::vector<TextColumn> columns = columns_of(parts, behind_last);
    const auto [place, is_new] = kinds_.try_emplace(
        {std::string(parts.prefix), words_of(columns, behind_last), fields.size()}, page_.tables.size());
    if (is_new)
      page_.tables.push_back({.prefix = std::string(parts.prefix),
                              .sample_line = std::string(line),
                              .columns = std::move(columns),
                              .rows = {}});
    TextTable& table = page_.tables[place->second];
    auto& row = table.rows.emplace_back();
    for (std::size_t i = 0; i < fields.size(); ++i) {
      row.push_back(finite_number(fields[i].value));
      table.columns[i].is_number &= !std::isnan(row.back());
      table.columns[i].decimals = std::max(table.columns[i].decimals, decimals_of(fields[i].value));
    }
  }

  static constexpr std::size_t headings_max = 64;  // more distinct ones are no headings

  TextPage page_;
  std::map<std::tuple<std::string, std::string, std::size_t>, std::size_t> kinds_;  // prefix, words, columns
  std::string room_;
};

}  // namespace

std::vector<std::size_t> TextTable::number_columns() const {
  std::vector<std::size_t> numbers;
  for (std::size_t column = 0; column < columns.size(); ++column)
    if (columns[column].is_number) numbers.push_back(column);
  return numbers;
}

bool is_readable(std::span<const std::uint8_t> bytes) {
  std::size_t characters = 0;  // bytes of them
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const std::uint8_t byte = bytes[i];
    const bool is_pair =
        byte >= 0xC2 && byte < 0xE0 && i + 1 < bytes.size() && (bytes[i + 1] & 0xC0U) == 0x80;
    characters += byte == '\r' || byte == '\n' || byte == '\t' || (byte >= ' ' && byte < 0x7F) ? 1U : 0U;
    if (!is_pair) continue;
    characters += 2;  // of UTF-8: a degree sign, a Greek letter
    ++i;
  }
  return !bytes.empty() && characters > bytes.size() - bytes.size() / 16;
}

std::optional<CountedLine> first_text_line(std::span<const std::uint8_t> bytes) {
  std::optional<CountedLine> first;
  for_each_line(bytes, [&](const RawLine& line) {
    if (first || is_blank(line.text) || !is_text(line.text)) return;
    first = {std::string(line.text), split_fields(line.text).size()};
  });
  return first;
}

TextPage read_page(std::span<const std::uint8_t> bytes, StreamStart start) {
  PageReader reader;
  bool whole = start == StreamStart::at_line_start;  // else the first line may be the tail of one
  for_each_line(bytes, [&](const RawLine& line) {
    if (whole) reader.add(line);
    whole = true;
  });
  return reader.page();
}

}  // namespace thermorig::sensors
