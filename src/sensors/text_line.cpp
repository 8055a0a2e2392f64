// SPDX-License-Identifier: MIT
#include "text_line.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "text_fields.h"

namespace thermorig::sensors {

namespace {

/// Reads wanted columns of one line and remembers whether all, and whether any, could be read.
class Columns {
 public:
  explicit Columns(std::string_view text) : fields_(split_fields(text)) {}

  /// The number in a column, which may be infinite or NaN; 0 for column -1, which is not wanted.
  double read(int column) {
    if (column < 0) return 0.0;
    const auto index = static_cast<std::size_t>(column);
    const std::optional<double> number =
        index < fields_.size() ? read_number(fields_[index].value) : std::optional<double>();
    any_number_ |= number.has_value();
    all_numbers_ &= number.has_value();
    return number.value_or(0.0);
  }

  std::size_t size() const { return fields_.size(); }
  bool any_number() const { return any_number_; }
  bool all_numbers() const { return all_numbers_; }

 private:
  std::vector<TextField> fields_;
  bool any_number_ = false;
  bool all_numbers_ = true;
};

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

}  // namespace

TextLine read_text_line(const TextColumns& columns, std::string_view line) {
  TextLine result;
  if (!line.starts_with(columns.prefix)) return result;
  Columns fields(line.substr(columns.prefix.size()));
  std::array<double, 3> numbers{};
  for (std::size_t axis = 0; axis < numbers.size(); ++axis) numbers[axis] = fields.read(columns.rate[axis]);
  const double time = fields.read(columns.time);

  result.fields = fields.size();
  result.is_sample = !columns.prefix.empty() || fields.any_number();
  GyroReading reading;
  keep_counts(numbers, reading);
  if (fields.all_numbers() && set_rates(numbers, columns.scale_dps, reading) &&
      (columns.time < 0 || set_device_time(time, columns.time_unit_s, reading)))
    result.reading = reading;
  return result;
}

}  // namespace thermorig::sensors
