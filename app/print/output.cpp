// SPDX-License-Identifier: MIT
#include "output.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <numeric>
#include <system_error>

#include "thermorig/io/host.h"

namespace thermorig::app {

bool escapes_allowed(std::FILE* stream) {
  return escapes_allowed(io::is_terminal(fileno(stream)), std::getenv("NO_COLOR"), std::getenv("TERM"));
}

bool escapes_allowed(bool is_terminal, const char* no_color, const char* term) {
  if (no_color != nullptr && *no_color != '\0') return false;
  if (term != nullptr && std::string_view(term) == "dumb") return false;
  return is_terminal;
}

std::string erasing(std::size_t lines) {
  return lines == 0 ? "\r" : fmt::format("\r\x1b[{}A\x1b[J", lines);
}

namespace {
int first_failure = 0;  // errno of standard output: the stream itself remembers only that there was one

void note_failure(std::FILE* stream, bool failed) {
  if (failed && stream == stdout && first_failure == 0) first_failure = errno;
}
}  // namespace

void write_to(std::FILE* stream, std::string_view text) {
  note_failure(stream, std::fwrite(text.data(), 1, text.size(), stream) < text.size());
}

void flush_output() {
  note_failure(stdout, std::fflush(stdout) != 0);
}

void require_printed(const std::string& advice) {
  flush_output();
  if (std::ferror(stdout) == 0) return;
  throw with_result(unwritten_output(first_failure), advice);
}

Error with_result(const Error& unwritten, const std::string& where) {
  const std::string& advice = unwritten.advice();
  return {unwritten.code(), unwritten.what_happened(), unwritten.where(),
          advice + (advice.empty() || where.empty() ? "" : "; ") + where};
}

Error unwritten_output(int error_number) {
  const auto told = [](const std::string& what, const char* advice) {
    return Error(ExitCode::storage, what, "standard output", advice);
  };
  if (error_number == EPIPE) return told("", "");
  const bool is_full = error_number == ENOSPC || error_number == EDQUOT || error_number == EFBIG;
  return told("the output could not be written: " + std::generic_category().message(error_number),
              is_full ? "free some space" : "write it to a file: > FILE");
}

std::string json_line(const nlohmann::json& object) {
  return object.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace) + "\n";
}

void print_json(const nlohmann::json& object) {
  const std::string line = json_line(object);
  write_to(stdout, line);
  flush_output();
}

std::string duration_text(double seconds) {
  if (!(seconds >= 0)) return "-";
  if (seconds < 59.95) return fmt::format("{:.1f} s", seconds);
  const auto whole = static_cast<std::int64_t>(std::llround(seconds));
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
}

std::string gap_text(double seconds) {
  if (!(seconds >= 0)) return "-";
  return seconds < 1 ? fmt::format("{:.0f} ms", seconds * 1e3) : fmt::format("{:.1f} s", seconds);
}

std::string bytes_text(std::uint64_t bytes) {
  constexpr std::array<const char*, 4> units{"kB", "MB", "GB", "TB"};
  if (bytes < 1000) return fmt::format("{} B", bytes);
  double size = static_cast<double>(bytes) / 1000;
  std::size_t unit = 0;
  while (size >= 999.95 && unit + 1 < units.size()) {
    size /= 1000;
    ++unit;
  }
  return fmt::format("{:.1f} {}", size, units[unit]);
}

std::string rate_range_text(double min_hz, double max_hz) {
  if (!(max_hz > 0)) return "-";
  return fmt::format("{:.1f}..{:.1f} /s", min_hz, max_hz);
}

std::string speed_text(double rate_dps) {
  return fmt::format("{:+.1f} deg/s", rate_dps);
}

std::string share_text(std::uint64_t part, std::uint64_t of) {
  if (of == 0) return "-";
  return fmt::format("{:.1f} %", 100.0 * static_cast<double>(part) / static_cast<double>(of));
}

namespace {
constexpr std::size_t gap = 2;  // between two columns

std::string padded(const std::string& cell, std::size_t width, bool right) {
  return (right ? fmt::format("{:>{}}", cell, width) : fmt::format("{:<{}}", cell, width)) +
         std::string(gap, ' ');
}
}  // namespace

Table::Table(std::vector<std::string> heading) {
  for (std::string& name : heading) {
    right_.push_back(name.starts_with('>'));
    if (right_.back()) name.erase(0, 1);
  }
  rows_.push_back(std::move(heading));
}

void Table::add(std::vector<std::string> row) {
  row.resize(right_.size());
  std::transform(row.begin(), row.end(), row.begin(), printable);
  rows_.push_back(std::move(row));
}

std::vector<std::size_t> Table::widths() const {
  std::vector<std::size_t> widths(right_.size(), 0);
  for (const auto& row : rows_)
    for (std::size_t column = 0; column < row.size(); ++column)
      widths[column] = std::max(widths[column], row[column].size());
  return widths;
}

std::size_t Table::column_of(const std::string& heading) const {
  const auto& headings = rows_.front();
  return static_cast<std::size_t>(std::find(headings.begin(), headings.end(), heading) - headings.begin());
}

void Table::remove(std::size_t column) {
  const auto at = static_cast<std::ptrdiff_t>(column);
  right_.erase(right_.begin() + at);
  for (auto& row : rows_) row.erase(row.begin() + at);
}

std::vector<std::string> Table::fit(std::size_t width, const std::vector<std::string>& by_importance) {
  const std::vector<std::size_t> needed = widths();
  std::vector<std::string> left_out;
  std::size_t used = 0;
  for (const std::string& heading : by_importance) {
    const std::size_t with = used + (used > 0 ? gap : 0) + needed[column_of(heading)];
    if (used == 0 || with <= width)
      used = with;
    else
      left_out.push_back(heading);
  }
  for (const std::string& heading : left_out) remove(column_of(heading));
  return left_out;
}

std::string Table::text_of(std::span<const std::size_t> columns, std::string_view indent) const {
  const std::vector<std::size_t> width = widths();
  std::string text;
  for (const auto& row : rows_) {
    std::string line(indent);
    for (const std::size_t column : columns) line += padded(row[column], width[column], right_[column]);
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

std::string Table::text(std::string_view indent) const {
  std::vector<std::size_t> all(right_.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return text_of(all, indent);
}

std::string Table::wrapped(std::size_t width) const {
  const std::vector<std::size_t> needed = widths();
  std::string text;
  std::vector<std::size_t> columns{0};
  std::size_t used = needed[0];
  const auto finish = [&] { text += (text.empty() ? "" : "\n") + text_of(columns, ""); };
  for (std::size_t column = 1; column < needed.size(); ++column) {
    if (columns.size() > 1 && used + gap + needed[column] > width) {
      finish();
      columns = {0};
      used = needed[0];
    }
    columns.push_back(column);
    used += gap + needed[column];
  }
  finish();
  return text;
}

}  // namespace thermorig::app
