// SPDX-License-Identifier: MIT
#include "text_line.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "text_fields.h"

namespace thermorig::sensors {

namespace {

/// The wanted columns of one line, read without keeping its fields.
struct Columns {
  std::array<double, 3> rate{};  // infinite or NaN as they stand; 0 for an axis that is not sent
  double time = 0.0;
  std::size_t fields = 0;
  std::size_t wanted = 0, numbers = 0;
};

Columns read_columns(const TextColumns& wanted, std::string_view line) {
  Columns columns;
  const std::array<std::pair<int, double*>, 4> places{{{wanted.rate[0], &columns.rate[0]},
                                                       {wanted.rate[1], &columns.rate[1]},
                                                       {wanted.rate[2], &columns.rate[2]},
                                                       {wanted.time, &columns.time}}};
  for (const auto& [column, place] : places) columns.wanted += column >= 0 ? 1U : 0U;
  Fields fields(line);
  bool behind_sign = false;  // "- 0.17": a number that would be read without its sign
  while (const std::optional<TextField> field = fields.next()) {
    const auto index = static_cast<int>(columns.fields++);
    for (const auto& [column, place] : places) {
      if (column != index) continue;
      const std::optional<double> number = behind_sign ? std::nullopt : read_number(field->value);
      columns.numbers += number ? 1U : 0U;
      *place = number.value_or(0.0);
    }
    behind_sign = is_sign(field->value);
  }
  return columns;
}

bool fits_count(double number) {
  return number == std::trunc(number) && number >= std::numeric_limits<std::int16_t>::min() &&
         number <= std::numeric_limits<std::int16_t>::max();
}

/// Raw counts are kept where all axes are whole numbers of 16 bits; others leave no counts.
void keep_counts(const std::array<double, 3>& numbers, GyroReading& reading) {
  if (!std::all_of(numbers.begin(), numbers.end(), fits_count)) return;
  for (std::size_t axis = 0; axis < numbers.size(); ++axis) {
    const auto count = static_cast<std::int16_t>(numbers[axis]);
    reading.counts[axis] = count;
    reading.saturated |= count == std::numeric_limits<std::int16_t>::min() ||
                         count == std::numeric_limits<std::int16_t>::max();
  }
}

/// False if a rate is infinite or NaN.
bool set_rates(const std::array<double, 3>& numbers, double scale_dps, GyroReading& reading) {
  for (std::size_t axis = 0; axis < numbers.size(); ++axis) {
    const double rate_dps = numbers[axis] * scale_dps;
    if (!(std::abs(rate_dps) <= static_cast<double>(std::numeric_limits<float>::max()))) return false;
    reading.rate_dps[axis] = static_cast<float>(rate_dps);
  }
  return true;
}

/// False if the time does not fit in microseconds of 64 bits.
bool set_device_time(double number, double unit_s, GyroReading& reading) {
  const double time_us = number * unit_s * 1e6;
  if (!(std::abs(time_us) < 9.2e18)) return false;
  reading.device_time_us = std::llround(time_us);
  return true;
}

/// At the end of a line, and as they would be formed.
struct Sums {
  unsigned said = 0;
  std::array<unsigned, 2> of_kinds{};  // XOR, sum
};

std::optional<Sums> sums_of(std::string_view line) {
  Sums sums;
  const std::size_t star = line.size() < 3 ? line.npos : line.find_last_not_of(" \t") - 2;
  const bool has_sum =
      star < line.size() && line[star] == '*' &&
      std::from_chars(&line[star] + 1, &line[star] + 3, sums.said, 16).ptr == &line[star] + 3;
  if (!has_sum) return std::nullopt;
  std::string_view summed = line.substr(0, star);
  summed.remove_prefix(std::min(summed.rfind('$') + 1, summed.size()));  // npos + 1: all of it
  for (const char c : summed) {
    sums.of_kinds[0] ^= static_cast<std::uint8_t>(c);
    sums.of_kinds[1] = (sums.of_kinds[1] + static_cast<std::uint8_t>(c)) & 0xFFU;
  }
  return sums;
}

}  // namespace

TextLine read_text_line(const TextColumns& columns, std::string_view line, std::string& room) {
  TextLine result;
  line = plain_text(line, room);
  if (!line.starts_with(columns.prefix)) line = behind_clock(line);
  if (!line.starts_with(columns.prefix)) return result;
  line.remove_prefix(columns.prefix.size());
  const Columns found = read_columns(columns, line);
  result.fields = found.fields;
  result.is_sample = !columns.prefix.empty() || found.numbers > 0;
  GyroReading reading;
  keep_counts(found.rate, reading);
  if (found.numbers == found.wanted && set_rates(found.rate, columns.scale_dps, reading) &&
      (columns.time < 0 || set_device_time(found.time, columns.time_unit_s, reading)) &&
      !has_decimal_commas(line))
    result.reading = reading;
  return result;
}

std::optional<bool> has_right_sum(std::string_view line) {
  const std::optional<Sums> sums = sums_of(line);
  if (!sums) return std::nullopt;
  return std::find(sums->of_kinds.begin(), sums->of_kinds.end(), sums->said) != sums->of_kinds.end();
}

bool LineSum::is_wrong(std::string_view line) {
  const std::optional<Sums> sums = sums_of(line);
  if (!sums) return kind_.has_value();
  if (kind_) return sums->of_kinds[*kind_] != sums->said;
  for (std::size_t kind = 0; kind < fitted_.size(); ++kind) {
    fitted_[kind] = sums->of_kinds[kind] == sums->said ? fitted_[kind] + 1 : 0;
    if (fitted_[kind] > 1) kind_ = kind;
  }
  return false;
}

}  // namespace thermorig::sensors
