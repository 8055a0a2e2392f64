// SPDX-License-Identifier: MIT
#include "thermorig/sensors/hand_turn.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "text_table.h"

namespace thermorig::sensors {

namespace {

constexpr std::size_t rows_of_a_turn = 20;

/// What a column did from rest to rest, about its level at rest.
struct Motion {
  double integral = 0.0;  // in units times rows
  double share_one_way = 0.0;
  double peak_to_rest = 0.0;  // over what it moves by at rest
  double stays_away = 0.0;    // how far its end is from its begin, of the peak
};

double mean_of(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

Motion motion_of(const std::vector<double>& values) {
  const std::size_t edge = values.size() / 10 + 1;  // it lies still at the begin and the end
  const std::span all(values);
  const double begin = mean_of(all.first(edge)), end = mean_of(all.last(edge));
  Motion motion;
  double both_ways = 0.0, peak = 0.0, at_rest = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double away = values[i] - begin;
    motion.integral += away;
    both_ways += std::abs(away);
    peak = std::max(peak, std::abs(away));
    if (i < edge) at_rest = std::max(at_rest, std::abs(away));
  }
  if (peak == 0.0) return motion;
  motion.share_one_way = std::abs(motion.integral) / both_ways;
  motion.peak_to_rest = peak / std::max(at_rest, 1e-3 * peak);
  motion.stays_away = std::abs(end - begin) / peak;
  return motion;
}

/// A hand is not steady, noise goes both ways, and a magnetic field that turned by 90 deg stays away by most
/// of its peak.
bool is_rate(const Motion& motion) {
  return motion.share_one_way > 0.7 && motion.peak_to_rest > 5.0 && motion.stays_away < 0.15;
}

constexpr std::array known_units{GyroUnit{1.0, "deg/s"},
                                 GyroUnit{57.29577951308232, "rad/s"},
                                 GyroUnit{1.0 / 131.0, "counts at +-250 deg/s"},
                                 GyroUnit{1.0 / 65.5, "counts at +-500 deg/s"},
                                 GyroUnit{1.0 / 32.8, "counts at +-1000 deg/s"},
                                 GyroUnit{1.0 / 16.4, "counts at +-2000 deg/s"},
                                 GyroUnit{1e-3, "mdeg/s"}};

const TextTable* table_like(const TextPage& page, const TextFormat& format) {
  for (const TextTable& table : page.tables)
    if (table.prefix == format.columns.prefix && table.columns.size() == format.fields &&
        table.rows.size() >= rows_of_a_turn)
      return &table;
  return nullptr;
}

}  // namespace

std::optional<GyroUnit> usual_gyro_unit(double scale_dps) {
  const auto distance = [&](const GyroUnit& unit) { return std::abs(std::log(unit.scale_dps / scale_dps)); };
  const auto nearest =
      std::min_element(known_units.begin(), known_units.end(),
                       [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
  return distance(*nearest) < std::log(4.0 / 3.0) ? std::optional(*nearest) : std::nullopt;
}

std::optional<HandTurn> turned_by_hand(std::span<const std::uint8_t> bytes, const TextFormat& format,
                                       double heard_s) {
  const TextPage page = read_page(bytes, StreamStart::anywhere);
  const TextTable* const table = table_like(page, format);
  if (table == nullptr) return std::nullopt;
  const auto& proposed = format.columns.rate;
  std::optional<std::size_t> turned;
  double most = 0.0;
  Motion of_turned;
  for (const std::size_t column : table->number_columns()) {
    const bool is_proposed =
        std::find(proposed.begin(), proposed.end(), static_cast<int>(column)) != proposed.end();
    if (static_cast<int>(column) == format.columns.time || (format.rates_known && !is_proposed)) continue;
    std::vector<double> values;
    for (const auto& row : table->rows) values.push_back(row[column]);
    const Motion motion = motion_of(values);
    if (!is_rate(motion) || std::abs(motion.integral) <= most) continue;
    most = std::abs(motion.integral);
    turned = column;
    of_turned = motion;
  }
  if (!turned) return std::nullopt;
  const double row_s = heard_s / static_cast<double>(table->rows.size());
  const std::optional<GyroUnit> unit = usual_gyro_unit(hand_turn_deg / (most * row_s));
  if (!unit) return std::nullopt;

  HandTurn result{.format = format, .axis = 2, .column = static_cast<int>(*turned)};
  const auto place = std::find(proposed.begin(), proposed.end(), result.column);
  if (place == proposed.end())
    result.format.columns.rate = {-1, -1, result.column};
  else
    result.axis = static_cast<int>(place - proposed.begin());
  result.format.columns.scale_dps = unit->scale_dps;
  result.format.rates_known = result.format.scale_known = true;
  result.format.assumptions = {fmt::format("column {} turned, by {:.0f} deg if its unit is {}", result.column,
                                           most * row_s * unit->scale_dps, unit->name)};
  return result;
}

}  // namespace thermorig::sensors
