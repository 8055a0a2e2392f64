// SPDX-License-Identifier: MIT
#include "text_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "text_fields.h"
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
    reader.words(words_until(digits.data()));
    reader.number();
    numbers.push_back(columns.size() - 1);
    column.name = bare_name(words_until(digits.data()));
    behind = digits.data() + digits.size();
  }
  behind_last = words_until(parts.words.data() + parts.words.size());
  reader.words(behind_last);
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

/// Gives the columns of a table the names of a header, if it has as many cells as the table's lines. A cell
/// may hold several columns ("2025-01-01 06:00:00"): its last number has the name.
bool take_names(const std::string& header, TextTable& table) {
  const std::string_view line = table.sample_line;
  for (const char separator : {'\t', ',', ';', ' '}) {
    const std::vector<std::string_view> names = cells_of(header, separator);
    const std::vector<std::string_view> cells = cells_of(line, separator);
    if (names.size() < 3 || names.size() != cells.size()) continue;
    const Parts parts = parts_of(line);
    std::size_t cell = 0, column = 0;
    std::vector<std::optional<std::size_t>> holds(cells.size());
    for (Fields fields(parts.columns); const auto field = fields.next(); ++column) {
      while (cell + 1 < cells.size() && field->text.data() >= cells[cell + 1].data()) ++cell;
      if (table.columns[column].is_number) holds[cell] = column;
    }
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (!holds[i]) continue;
      WordReader reader;
      reader.words(names[i]);
      reader.number();
      table.columns[*holds[i]].name = bare_name(names[i]);
      table.columns[*holds[i]].meaning = reader.meanings().front();
      if (!reader.meanings().front().axis_named) table.columns[*holds[i]].meaning.axis.reset();
    }
    return true;
  }
  return false;
}

bool has_words(const TextTable& table) {
  return std::any_of(table.columns.begin(), table.columns.end(), [](const TextColumn& column) {
    return column.meaning.quantity != Quantity::none || column.meaning.axis_named;
  });
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
    const Parts parts = parts_of(text);
    if (leading_text(parts.columns).size() == parts.columns.size()) return add_heading(text);
    ++page_.rows;
    page_.rows_with_decimal_commas += has_decimal_commas(text) ? 1U : 0U;
    add_row(text, parts);
  }

  TextPage page() {
    for (TextTable& table : page_.tables) {
      if (has_words(table)) continue;
      for (auto header = page_.headings.rbegin(); header != page_.headings.rend(); ++header)
        if (take_names(*header, table)) break;
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
  const auto characters = std::count_if(bytes.begin(), bytes.end(), [](std::uint8_t byte) {
    return byte == '\r' || byte == '\n' || byte == '\t' || (byte >= ' ' && byte < 0x7F);
  });
  return !bytes.empty() && static_cast<std::size_t>(characters) > bytes.size() - bytes.size() / 16;
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
