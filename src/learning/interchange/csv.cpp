// SPDX-License-Identifier: MIT
#include "thermorig/learning/interchange/formats.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <type_traits>

namespace thermorig::interchange {

namespace {

constexpr std::size_t buffer_bytes = 1U << 16U;

/// Where the decimal point is a comma, spreadsheets take `;` for the separator: what holds one is quoted as
/// well, or a formula could stand behind it. They skip blanks in front of one.
void append_text(std::string& line, std::string_view text) {
  const std::size_t first = text.find_first_not_of(' ');
  const bool is_formula = first != std::string_view::npos &&
                          std::string_view("=+-@\t\r").find(text[first]) != std::string_view::npos;
  const std::string shown = fmt::format("{}{}", is_formula ? "'" : "", text);
  if (shown.find_first_of(",;\t\"\r\n") == std::string::npos) {
    line += shown;
    return;
  }
  line += '"';
  for (const char c : shown) line.append(c == '"' ? 2 : 1, c);
  line += '"';
}

void append_value(std::string& line, const Value& value) {
  std::visit(
      [&](const auto& held) {
        using Held = std::decay_t<decltype(held)>;
        if constexpr (std::is_same_v<Held, std::string>) {
          append_text(line, held);
        } else if constexpr (std::is_floating_point_v<Held>) {
          if (!std::isnan(held)) fmt::format_to(std::back_inserter(line), "{}", held);
        } else {
          fmt::format_to(std::back_inserter(line), "{}", held);
        }
      },
      value);
}

/// A line after another, written when there are many.
class Lines {
 public:
  explicit Lines(Sink& sink) : sink_(sink) {}

  template <typename Append>
  void add(std::size_t fields, Append append) {
    for (std::size_t i = 0; i < fields; ++i) {
      if (i > 0) text_ += ',';
      append(text_, i);
    }
    text_ += "\r\n";
    if (text_.size() >= buffer_bytes) flush();
  }

  void flush() {
    sink_.write(std::string_view(text_));
    text_.clear();
  }

 private:
  Sink& sink_;
  std::string text_;
};

}  // namespace

void write_csv(const Table& table, Sink& sink) {
  Lines lines(sink);
  const std::vector<Column>& columns = table.columns;
  lines.add(columns.size(), [&](std::string& line, std::size_t i) {
    append_text(line, columns[i].units.empty() ? columns[i].name
                                               : fmt::format("{} [{}]", columns[i].name, columns[i].units));
  });
  for (std::size_t row = 0; row < table.rows; ++row)
    lines.add(columns.size(),
              [&](std::string& line, std::size_t i) { append_value(line, columns[i].at(row)); });
  lines.flush();
}

}  // namespace thermorig::interchange
