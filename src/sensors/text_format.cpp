// SPDX-License-Identifier: MIT
#include "thermorig/sensors/text_format.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>

#include "text_table.h"

namespace thermorig::sensors {

namespace {

// What names such as "gx_dps", "gyro.x", "t_ms" say about a column.

constexpr std::string_view axis_letters = "xyz";
constexpr double mpu6050_counts_per_dps = 131.0;  // at +-250 deg/s, its setting after a reset

std::string lower(std::string name) {
  std::transform(name.begin(), name.end(), name.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return name;
}

bool is_small_letter(char c) {
  return c >= 'a' && c <= 'z';
}

/// Whether `text` stands in `name` as a word: no letter before or behind it.
bool has_word(const std::string& name, std::string_view text) {
  for (std::size_t at = name.find(text); at != std::string::npos; at = name.find(text, at + 1)) {
    const std::size_t end = at + text.size();
    if ((at == 0 || !is_small_letter(name[at - 1])) && (end == name.size() || !is_small_letter(name[end])))
      return true;
  }
  return false;
}

bool has_any_word(const std::string& name, std::initializer_list<std::string_view> words) {
  return std::any_of(words.begin(), words.end(), [&](std::string_view word) { return has_word(name, word); });
}

/// Whether a name means the rate about an axis (0, 1, 2: x, y, z).
bool names_rate(const std::string& name, std::size_t axis) {
  const std::string text = lower(name);
  const std::string letter(1, axis_letters[axis]);
  for (const std::string stem : {"g", "w", "gyr", "gyro", "rot", "rotation", "omega", "rate"}) {
    if (has_word(text, stem + letter)) return true;
    if (stem.size() > 1 && has_word(text, stem) && has_word(text, letter))
      return true;  // "g" alone is gravity
  }
  return false;
}

/// Degrees per second of one unit; none where the name has no unit.
std::optional<double> named_scale_dps(const std::string& name) {
  const std::string text = lower(name);
  if (has_any_word(text, {"rad", "rads", "radps"})) return 180.0 / std::numbers::pi;
  if (has_word(text, "mdps")) return 1e-3;
  if (has_any_word(text, {"raw", "counts", "lsb"})) return 1.0 / mpu6050_counts_per_dps;
  if (has_any_word(text, {"dps", "deg", "degs"})) return 1.0;
  return std::nullopt;
}

bool names_time(const std::string& name) {
  return has_any_word(lower(name),
                      {"t", "time", "timestamp", "s", "sec", "ms", "us", "millis", "micros", "seconds"});
}

/// Seconds of one unit; none where the name has no unit.
std::optional<double> named_time_unit_s(const std::string& name) {
  const std::string text = lower(name);
  if (has_any_word(text, {"us", "micros"})) return 1e-6;
  if (has_any_word(text, {"ms", "millis"})) return 1e-3;
  if (has_any_word(text, {"s", "sec", "seconds"})) return 1.0;
  return std::nullopt;
}

constexpr std::size_t axes = 3;
constexpr std::size_t rows_needed = 2;
constexpr std::size_t rows_of_a_clock = 8;             // a rate that rises through so many lines is none
constexpr double usual_period_s = 0.01;                // where nobody knows how long the lines took
constexpr std::string_view i2cdevlib_prefix = "a/g:";  // MPU6050_raw: ax ay az gx gy gz, counts
constexpr double i2cdevlib_counts_per_dps = 131.0;     // at +-250 deg/s, which that sketch sets

std::vector<double> steps_of(const TextTable& table, std::size_t column) {
  std::vector<double> steps;
  for (std::size_t row = 1; row < table.rows.size(); ++row)
    steps.push_back(table.rows[row][column] - table.rows[row - 1][column]);
  std::sort(steps.begin(), steps.end());
  return steps;
}

/// A clock rises from line to line; few lines must do so in nearly equal steps as well.
bool runs_like_a_clock(const TextTable& table, std::size_t column) {
  const std::vector<double> steps = steps_of(table, column);
  if (steps.empty() || steps.front() <= 0) return false;
  return table.rows.size() >= rows_of_a_clock || (steps.size() > 1 && steps.back() <= 2 * steps.front());
}

/// The unit that brings the usual step nearest to the lines' period.
double unit_of_clock(const TextTable& table, std::size_t column, double heard_s) {
  const std::vector<double> steps = steps_of(table, column);
  const double step = steps[steps.size() / 2];
  const double period_s = heard_s > 0 ? heard_s / static_cast<double>(table.rows.size()) : usual_period_s;
  constexpr std::array units_s{1.0, 1e-3, 1e-6};
  return *std::min_element(units_s.begin(), units_s.end(), [&](double a, double b) {
    return std::abs(std::log(step * a / period_s)) < std::abs(std::log(step * b / period_s));
  });
}

std::string unit_text(double unit_s) {
  if (unit_s == 1e-6) return "microseconds";
  return unit_s == 1e-3 ? "milliseconds" : "seconds";
}

/// Fills in a format's columns from a table, and says why.
class Guess {
 public:
  Guess(const TextTable& table, double heard_s)
      : table_(table), numbers_(table.number_columns()), heard_s_(heard_s) {
    format_.columns.prefix = table.prefix;
    format_.sample_line = table.sample_line;
    format_.fields = table.names.size();
    format_.lines = table.rows.size();
    format_.bytes = table.bytes;
  }

  std::optional<TextFormat> format() {
    if (table_.rows.size() < rows_needed || numbers_.size() < axes) return std::nullopt;
    if (table_.names.size() >= image_line_fields) return std::nullopt;
    find_time();
    if (!find_named_rates()) find_rates_by_order();
    return format_;
  }

 private:
  void find_time() {
    const auto named = std::find_if(numbers_.begin(), numbers_.end(), [&](std::size_t column) {
      return names_time(table_.names[column]) && runs_like_a_clock(table_, column);
    });
    const auto time = named == numbers_.end() ? numbers_.begin() : named;
    if (numbers_.size() == axes || !runs_like_a_clock(table_, *time)) return;
    const double unit_s =
        named_time_unit_s(table_.names[*time]).value_or(unit_of_clock(table_, *time, heard_s_));
    format_.columns.time = static_cast<int>(*time);
    format_.columns.time_unit_s = unit_s;
    say(fmt::format("column {} runs like a clock, in {}", *time, unit_text(unit_s)));
    numbers_.erase(time);
  }

  bool find_named_rates() {
    std::array<int, axes> rate{};
    for (std::size_t axis = 0; axis < axes; ++axis) {
      const auto found = std::find_if(numbers_.begin(), numbers_.end(), [&](std::size_t column) {
        return names_rate(table_.names[column], axis);
      });
      if (found == numbers_.end()) return false;
      rate[axis] = static_cast<int>(*found);
    }
    const std::string& name = table_.names[static_cast<std::size_t>(rate[0])];
    const std::optional<double> scale_dps = named_scale_dps(name);
    format_.columns.rate = rate;
    format_.rates_known = true;
    format_.columns.scale_dps = scale_dps.value_or(1.0);
    say(fmt::format("{} are the rates by their names ({} ...){}", columns_text(), name,
                    scale_dps ? "" : "; 1 deg/s a unit is assumed"));
    return true;
  }

  void find_rates_by_order() {
    const bool is_i2cdevlib = table_.prefix == i2cdevlib_prefix && numbers_.size() == 2 * axes;
    for (std::size_t axis = 0; axis < axes; ++axis)
      format_.columns.rate[axis] = static_cast<int>(numbers_[numbers_.size() - axes + axis]);
    if (!is_i2cdevlib)
      return say(fmt::format("{} are taken as the rates; 1 deg/s a unit is assumed", columns_text()));
    format_.columns.scale_dps = 1.0 / i2cdevlib_counts_per_dps;
    format_.rates_known = true;
    say(
        fmt::format("{} are taken as the rates behind the accelerations, as i2cdevlib prints them; 1/{} "
                    "deg/s a count is assumed (MPU6050 at +-250 deg/s)",
                    columns_text(), i2cdevlib_counts_per_dps));
  }

  std::string columns_text() const {
    const auto& rate = format_.columns.rate;
    return fmt::format("columns {},{},{}", rate[0], rate[1], rate[2]);
  }

  void say(std::string sentence) { format_.assumptions.push_back(std::move(sentence)); }

  const TextTable& table_;
  std::vector<std::size_t> numbers_;  // columns that may be rates
  double heard_s_;
  TextFormat format_;
};

}  // namespace

std::optional<TextFormat> guess_text_format(std::span<const std::uint8_t> bytes, StreamStart start,
                                            double heard_s) {
  const TextTable table = most_frequent_table(bytes, start);
  return Guess(table, heard_s).format();
}

}  // namespace thermorig::sensors
