// SPDX-License-Identifier: MIT
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "terminal_width.h"
#include "thermorig/core/count_text.h"
#include "thermorig/core/error.h"
#include "thermorig/core/printable.h"

namespace thermorig::app {

/// May colours and cursor movements be written to `stream`? Only to a terminal that is not "dumb", and not if
/// NO_COLOR is set (https://no-color.org).
bool escapes_allowed(std::FILE* stream);

/// The same of a stream that is a terminal or is none, where NO_COLOR and TERM have these values; null: not
/// set.
bool escapes_allowed(bool is_terminal, const char* no_color, const char* term);

/// Goes up over the `lines` that were drawn last, and clears to the end of the screen. The cursor stands
/// behind a "^C" if the terminal has echoed one.
std::string erasing(std::size_t lines);

/// Never throws: what a command makes does not depend on who reads what it prints. A failure stays with the
/// stream, for require_printed().
void write_to(std::FILE* stream, std::string_view text);

/// The text for people: see folded().
template <typename... Parts>
void print(std::FILE* stream, fmt::format_string<Parts...> format, Parts&&... parts) {
  write_to(stream, folded(fmt::format(format, std::forward<Parts>(parts)...)));
}

/// To standard output.
template <typename... Parts>
void print(fmt::format_string<Parts...> format, Parts&&... parts) {
  write_to(stdout, folded(fmt::format(format, std::forward<Parts>(parts)...)));
}

/// Never throws, as write_to().
void flush_output();

/// Flushes standard output. Throws Error(storage) if not all that was ever printed to it could be written;
/// `advice`: where else the result is.
void require_printed(const std::string& advice = "");

/// What is told where standard output took something not: its disk is full, ... Of a reader that went away
/// what_happened() is empty: so pipes end, and report() prints no error.
Error unwritten_output(int error_number);

/// The same error, with where else the result is.
Error with_result(const Error& unwritten, const std::string& where);

/// One object as one line of ASCII: what is not, is escaped as JSON, and so steers no terminal. Text that is
/// not UTF-8 is replaced, NaN becomes null.
std::string json_line(const nlohmann::json& object);

/// One object on one line of standard output, flushed.
void print_json(const nlohmann::json& object);

// Numbers for people, beside count_text().
std::string duration_text(double seconds);                     // 0.8 s, 31.2 s, 12 min 3 s, 1 h 47 min
std::string gap_text(double seconds);                          // 4 ms, 126 ms, 2.5 s
std::string bytes_text(std::uint64_t bytes);                   // 940 B, 6.3 MB
std::string rate_range_text(double min_hz, double max_hz);     // 7.8..8.0 /s
std::string speed_text(double rate_dps);                       // +7.5 deg/s
std::string share_text(std::uint64_t part, std::uint64_t of);  // 95.0 %, "-" of nothing

/// Columns side by side, two spaces apart. A column whose heading begins with '>' is set flush right; the '>'
/// is not printed. Cells are printable(), as they often come from outside.
class Table {
 public:
  explicit Table(std::vector<std::string> heading);
  void add(std::vector<std::string> row);
  /// Leaves out what does not fit into lines of `width`: a column is kept if it fits beside those whose
  /// headings stand before its own in `by_importance`, the first one always. Returns the headings of the
  /// others.
  std::vector<std::string> fit(std::size_t width, const std::vector<std::string>& by_importance);
  std::string text(std::string_view indent = "") const;
  /// In as many tables below each other as lines of `width` need, each with the first column.
  std::string wrapped(std::size_t width) const;

 private:
  std::vector<std::size_t> widths() const;
  std::string text_of(std::span<const std::size_t> columns, std::string_view indent) const;
  std::size_t column_of(const std::string& heading) const;
  void remove(std::size_t column);

  std::vector<bool> right_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace thermorig::app
