// SPDX-License-Identifier: MIT
#include "thermorig/sensors/text_format.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "text_fields.h"
#include "text_line.h"
#include "text_table.h"
#include "thermorig/sensors/gyro_sketch.h"

namespace thermorig::sensors {

namespace {

constexpr std::size_t axes = 3;
constexpr std::size_t rows_needed = 2;
constexpr std::size_t rows_of_a_clock = 8;        // a rate that rises through so many lines is none
constexpr std::size_t rows_of_a_rest = 8;         // a sensor that is there shows its noise in so many
constexpr double usual_period_s = 0.01;           // where nobody knows how long the lines took
constexpr double mpu6050_counts_per_dps = 131.0;  // at +-250 deg/s, its setting after a reset

constexpr std::string_view angles_of_bno055 = "CALIBRATION: Sys=";  // X, Y, Z before it are Euler angles

std::vector<double> steps_of(const TextTable& table, std::size_t column) {
  std::vector<double> steps;
  for (std::size_t row = 1; row < table.rows.size(); ++row)
    steps.push_back(table.rows[row][column] - table.rows[row - 1][column]);
  std::sort(steps.begin(), steps.end());
  return steps;
}

bool is_constant(const TextTable& table, std::size_t column) {
  return std::all_of(table.rows.begin(), table.rows.end(),
                     [&](const auto& row) { return row[column] == table.rows.front()[column]; });
}

/// A clock rises from line to line. Where no word calls it time, and where lines are few, it must do so in
/// nearly equal steps as well: nine of ten.
bool runs_like_a_clock(const TextTable& table, std::size_t column, bool is_named) {
  const std::vector<double> steps = steps_of(table, column);
  if (steps.empty() || steps.front() <= 0) return false;
  if (!is_named && steps.front() == 1.0 && steps.back() == 1.0) return false;  // a count of lines
  if (is_named && table.rows.size() >= rows_of_a_clock) return true;
  return steps.size() > 1 && steps[steps.size() * 9 / 10] <= 2 * steps[steps.size() / 10];
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

/// Seconds of one unit; none where the name has no unit.
std::optional<double> named_time_unit_s(const std::string& name) {
  std::string words = " ";
  for (const char c : name)
    words += std::isalpha(static_cast<unsigned char>(c)) ? static_cast<char>(std::tolower(c)) : ' ';
  words += ' ';
  const auto has = [&](const char* word) { return words.find(fmt::format(" {} ", word)) != words.npos; };
  if (has("ns") || has("nanoseconds")) return 1e-9;
  if (has("us") || has("micros") || has("microseconds")) return 1e-6;
  if (has("ms") || has("millis") || has("milliseconds")) return 1e-3;
  if (has("s") || has("sec") || has("seconds")) return 1.0;
  return std::nullopt;
}

/// "t (10us)", "time [h]": a clock in a unit that is not read.
bool has_odd_unit(const std::string& name) {
  const std::size_t bracket = name.find_last_of("([");
  return bracket != name.npos && bracket + 1 < name.size() &&
         (is_digit(name[bracket + 1]) || !named_time_unit_s(name.substr(bracket)));
}

std::string unit_text(double unit_s) {
  if (unit_s == 1e-9) return "nanoseconds";
  if (unit_s == 1e-6) return "microseconds";
  return unit_s == 1e-3 ? "milliseconds" : "seconds";
}

using Rates = std::array<int, axes>;  // columns, -1: none

std::size_t count_of(const Rates& rates) {
  return static_cast<std::size_t>(
      std::count_if(rates.begin(), rates.end(), [](int column) { return column >= 0; }));
}

/// The column of the first axis that has one.
int first_of(const Rates& rates) {
  if (rates[0] >= 0) return rates[0];
  return rates[1] >= 0 ? rates[1] : rates[2];
}

/// The columns that are rates about x, y, z by words, or by a unit alone where no word names them: all three,
/// or those whose axis has a name. None where two columns are called the same.
Rates named_rates(const TextTable& table) {
  const auto are_rates = [&](bool named) {
    Rates rates{-1, -1, -1};
    bool axes_named = true;
    for (std::size_t column = 0; column < table.columns.size(); ++column) {
      const Meaning& meaning = table.columns[column].meaning;
      if (meaning.quantity != Quantity::rate || !meaning.axis || !table.columns[column].is_number) continue;
      if (meaning.is_named != named) continue;
      if (rates[*meaning.axis] >= 0) return Rates{-1, -1, -1};
      rates[*meaning.axis] = static_cast<int>(column);
      axes_named &= meaning.axis_named;
    }
    return count_of(rates) == axes || (axes_named && named) ? rates : Rates{-1, -1, -1};
  };
  const bool any_named =
      std::any_of(table.columns.begin(), table.columns.end(), [](const TextColumn& column) {
        return column.meaning.quantity == Quantity::rate && column.meaning.is_named;
      });
  return are_rates(any_named);
}

/// deg/s of one unit, if the words say the same of each axis that there is; else 0.
double scale_of(const TextTable& table, const Rates& rates) {
  std::optional<double> scale_dps;
  for (const int column : rates) {
    if (column < 0) continue;
    const double of_axis_dps = table.columns[static_cast<std::size_t>(column)].meaning.scale_dps;
    if (scale_dps.value_or(of_axis_dps) != of_axis_dps) return 0.0;
    scale_dps = of_axis_dps;
  }
  return scale_dps.value_or(0.0);
}

/// "gz" of lines that call two columns so; empty: none.
std::string named_twice(const TextTable& table) {
  std::array<bool, axes> seen{};
  for (const TextColumn& column : table.columns) {
    const Meaning& meaning = column.meaning;
    if (meaning.quantity != Quantity::rate || !meaning.is_named || !meaning.axis || !column.is_number)
      continue;
    if (std::exchange(seen[*meaning.axis], true)) return column.name;
  }
  return "";
}

/// Three columns whose length is that of gravity in a unit, on nearly all rows: a shock is none.
bool measure_gravity(const TextTable& table, std::span<const std::size_t> three, double unit) {
  const auto rows = std::count_if(table.rows.begin(), table.rows.end(), [&](const auto& row) {
    const double norm = std::hypot(row[three[0]], row[three[1]], row[three[2]]);
    return norm > 0.8 * unit && norm < 1.2 * unit;
  });
  return 10 * static_cast<std::size_t>(rows) >= 9 * table.rows.size();
}

/// So in any usual unit.
bool is_gravity(const TextTable& table, std::span<const std::size_t> three) {
  constexpr std::array units{1.0, 9.81, 1000.0, 2048.0, 4096.0, 8192.0, 16384.0};
  return std::none_of(three.begin(), three.end(),
                      [&](std::size_t column) { return is_constant(table, column); }) &&
         std::any_of(units.begin(), units.end(),
                     [&](double unit) { return measure_gravity(table, three, unit); });
}

/// Another sketch may use the same words for other units: its accelerations tell.
bool fits(const GyroSketch& sketch, const TextTable& table) {
  if (sketch.gravity == 0.0) return true;
  std::vector<std::size_t> accelerations;
  for (const std::size_t column : table.number_columns())
    if (table.columns[column].meaning.quantity == Quantity::acceleration ||
        (sketch.first_number >= 0 && accelerations.size() < static_cast<std::size_t>(sketch.first_number)))
      accelerations.push_back(column);
  return accelerations.size() == axes && measure_gravity(table, accelerations, sketch.gravity);
}

/// A column's name in small letters, without its digits: "IMU_1" is "imu".
std::string letters_of(const TextTable& table, std::size_t column) {
  std::string letters;
  for (const char c : table.columns[column].name)
    if (is_letter(c)) letters += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return letters;
}

/// Four numbers, perhaps with an accuracy behind them, that are as long as 1: "w: 0.99 x: ... z: ...".
/// Columns without a name have decimals: a gyro at rest behind a count of 1 is none.
bool is_quaternion(const TextTable& table) {
  constexpr std::size_t rows_of_chance = 4;
  constexpr auto parts = std::to_array<std::string_view>({"w", "x", "y", "z", "i", "j", "k", "r", "real"});
  std::vector<std::size_t> numbers;
  for (const std::size_t column : table.number_columns()) {
    if (table.columns[column].meaning.quantity == Quantity::time) continue;
    const std::string name = letters_of(table, column);
    const bool is_part =
        name.empty() ? table.columns[column].decimals > 0
                     : name.starts_with('q') || std::find(parts.begin(), parts.end(), name) != parts.end();
    if (numbers.size() < 4 && !is_part) return false;
    numbers.push_back(column);
  }
  if (table.rows.size() < rows_of_chance || (numbers.size() != 4 && numbers.size() != 5)) return false;
  return std::all_of(table.rows.begin(), table.rows.end(), [&](const auto& row) {
    const double norm = std::hypot(std::hypot(row[numbers[0]], row[numbers[1]]),
                                   std::hypot(row[numbers[2]], row[numbers[3]]));
    return std::abs(norm - 1.0) < 0.02;
  });
}

/// A column of a few whole numbers that come by turns and say whose line it is: "imu=1". `numbers` gets them.
bool names_sensors(const TextTable& table, std::size_t column, std::set<double>& numbers) {
  const std::string name = letters_of(table, column);
  constexpr auto words = std::to_array<std::string_view>({"id", "imu", "imuid", "sensor", "sensorid", "dev",
                                                          "device", "deviceid", "node", "nodeid", "channel",
                                                          "ch", "addr", "address", "mpu", "board"});
  if (!table.columns[column].is_number || std::find(words.begin(), words.end(), name) == words.end())
    return false;
  for (const auto& row : table.rows) numbers.insert(row[column]);
  constexpr std::size_t sensors_most = 8;
  const auto is_number_of_one = [](double number) { return number >= 0.0 && number == std::trunc(number); };
  return std::all_of(numbers.begin(), numbers.end(), is_number_of_one) && numbers.size() > 1 &&
         numbers.size() <= sensors_most && 2 * numbers.size() <= table.rows.size();
}

/// Finds the lines of rates on a page, and says why.
class Recogniser {
 public:
  Recogniser(const TextPage& page, double heard_s) : page_(page), heard_s_(heard_s) {}

  std::optional<TextFormat> format() {
    if (2 * page_.with_hex > page_.lines)
      return refuse("its numbers are hexadecimal", "print them in decimal: Serial.print(gx), without HEX");
    if (page_.with_minus_signs >= rows_needed)
      return refuse("its minus signs are a character of their own (U+2212), not \"-\"",
                    "print or export plain text; of a file: sed 's/\xE2\x88\x92/-/g'");
    if (most_frequent() == nullptr) return std::nullopt;
    if (page_.headers_differ)
      return refuse("two headers name its columns differently",
                    "give decode the part of the file below one of them");
    if (10 * page_.with_stray_signs > page_.rows)
      return refuse("a blank stands between a sign and its number", "print \"-0.17\", not \"- 0.17\"");
    if (2 * page_.with_decimal_commas > page_.rows)
      return refuse(
          "its numbers have decimal commas, or commas that group digits, and a comma separates columns",
          "print points; of a file whose columns lie between semicolons or tabs: tr , . <FILE | thermorig "
          "decode --device gyro -");
    const TextTable* const named = best_named();
    if (is_quaternion(*most_frequent()) &&
        (named == nullptr || (named == most_frequent() && scale_of(*named, named_rates(*named)) == 0.0))) {
      note(Quantity::quaternion);
      return refuse_other_things();
    }
    if (named != nullptr) return of_named(*named);
    if (const GyroSketch* sketch = sketch_of_order()) return of_order(*sketch);
    for (const TextTable& table : page_.tables)
      if (const std::string name = named_twice(table); is_enough(table) && !name.empty())
        return refuse(fmt::format("two of its columns are rates about one axis (\"{}\")", name),
                      "print only one; or fill in [gyro.text] of the profile: rate = the columns, from 0");
    if (is_of_other_things()) return refuse_other_things();
    return of_numbers(*most_frequent());
  }

 private:
  static bool is_enough(const TextTable& table) { return table.rows.size() >= rows_needed; }

  /// A device that prints lines of acceleration and of rates by turns marks the latter.
  const TextTable* most_frequent() const {
    const auto weight = [](const TextTable& table) {
      const bool is_marked = table.prefix.starts_with('g') || table.prefix.starts_with('G');
      return table.rows.size() * (is_marked ? 2 : 1);
    };
    const TextTable* best = nullptr;
    for (const TextTable& table : page_.tables)
      if (is_enough(table) && (best == nullptr || weight(table) > weight(*best))) best = &table;
    return best;
  }

  /// Most axes first, then z, which is the servo's in most rigs, then a unit, then most lines.
  const TextTable* best_named() const {
    const auto merit = [](const TextTable& table) {
      const Rates rates = named_rates(table);
      const bool has_unit = scale_of(table, rates) > 0.0;
      return std::tuple(count_of(rates), rates[2] >= 0, has_unit, table.rows.size());
    };
    const TextTable* best = nullptr;
    for (const TextTable& table : page_.tables)
      if (is_enough(table) && count_of(named_rates(table)) > 0 &&
          (best == nullptr || merit(table) > merit(*best)))
        best = &table;
    return best;
  }

  bool is_on_page(std::string_view mark) const {
    const auto holds = [&](const std::string& line) { return line.find(mark) != line.npos; };
    return std::any_of(page_.headings.begin(), page_.headings.end(), holds) ||
           std::any_of(page_.tables.begin(), page_.tables.end(),
                       [&](const TextTable& table) { return holds(table.sample_line); });
  }

  const GyroSketch* sketch_of_names() const {
    const auto found =
        std::find_if(gyro_sketches().begin(), gyro_sketches().end(), [&](const GyroSketch& sketch) {
          return sketch.mark_tells_unit && sketch.first_number < 0 && is_on_page(sketch.mark) &&
                 fits(sketch, *table_);
        });
    return found == gyro_sketches().end() ? nullptr : &*found;
  }

  const TextTable* table_of(const GyroSketch& sketch) const {
    for (const TextTable& table : page_.tables)
      if (is_enough(table) && table.prefix.starts_with(sketch.mark) &&
          table.number_columns().size() == static_cast<std::size_t>(sketch.first_number) + axes &&
          fits(sketch, table))
        return &table;
    return nullptr;
  }

  const GyroSketch* sketch_of_order() const {
    const auto found = std::find_if(
        gyro_sketches().begin(), gyro_sketches().end(),
        [&](const GyroSketch& sketch) { return sketch.first_number >= 0 && table_of(sketch) != nullptr; });
    return found == gyro_sketches().end() ? nullptr : &*found;
  }

  TextFormat begin(const TextTable& table) {
    table_ = &table;
    numbers_ = table.number_columns();
    format_.columns.prefix = table.prefix;
    format_.sample_line = table.sample_line;
    format_.fields = table.columns.size();
    format_.lines = table.rows.size();
    format_.bytes = page_.bytes;
    return format_;
  }

  TextFormat of_named(const TextTable& table) {
    begin(table);
    take_rates(named_rates(table));
    find_time();
    const auto& [name, meaning, is_number, decimals] = table.columns[static_cast<std::size_t>(first_rate())];
    const double scale_dps = scale_of(table, format_.columns.rate);
    say(fmt::format("{} are the rates by the words \"{}\"", columns_text(), name));
    if (count_of(format_.columns.rate) < axes) say_one_axis();
    if (scale_dps > 0.0)
      take_scale(scale_dps, fmt::format("their unit is {}, as the words say", meaning.unit));
    else if (const GyroSketch* sketch = sketch_of_names())
      take_scale(sketch->columns.scale_dps, fmt::format("{} prints {}", sketch->title, sketch->prints));
    else
      leave_scale_open(meaning.unit);
    return finish();
  }

  TextFormat of_order(const GyroSketch& sketch) {
    begin(*table_of(sketch));
    Rates rates{};
    for (std::size_t axis = 0; axis < axes; ++axis)
      rates[axis] = static_cast<int>(numbers_[static_cast<std::size_t>(sketch.first_number) + axis]);
    take_rates(rates);
    take_scale(sketch.columns.scale_dps,
               fmt::format("{} are the rates: {} prints {}", columns_text(), sketch.title, sketch.prints));
    return finish();
  }

  /// Nothing on the lines says what they are; what stands above them may.
  std::optional<TextFormat> of_numbers(const TextTable& table) {
    if (table.number_columns().size() < axes || table.columns.size() >= image_line_fields)
      return std::nullopt;
    begin(table);
    find_time();
    if (numbers_.size() < axes) return std::nullopt;
    const bool is_time_a_guess = numbers_.size() < table.number_columns().size();
    if (numbers_.size() == axes && is_headed_by_rates() &&
        (!is_time_a_guess || above_.has_named(Quantity::time))) {
      take_rates(in_named_order(0));
      say(fmt::format("{} are the rates, as the lines above say", columns_text()));
      if (above_.said_scale_dps() > 0.0)
        take_scale(above_.said_scale_dps(),
                   fmt::format("their unit is {}, as the lines above say", above_.said_unit()));
      else
        leave_scale_open();
      return finish();
    }
    guess_rates();
    leave_scale_open();
    return finish();
  }

  /// Those behind the accelerations, which show by their length; else the last three.
  void guess_rates() {
    std::size_t at = numbers_.size() - axes;
    for (std::size_t i = 0; i + 2 * axes <= numbers_.size(); ++i)
      if (is_gravity(*table_, std::span(numbers_).subspan(i, axes))) {
        at = i + axes;
        say(fmt::format("columns {},{},{} look like accelerations", numbers_[i], numbers_[i + 1],
                        numbers_[i + 2]));
        break;
      }
    format_.columns.rate = in_named_order(at);
    say(fmt::format("{} are taken as the rates, which is a guess", columns_text()));
  }

  /// Three columns, by the axes that a header names ("z,y,x") or in their order.
  Rates in_named_order(std::size_t at) const {
    Rates named{-1, -1, -1}, ordered{};
    for (std::size_t i = 0; i < axes; ++i) {
      const std::size_t column = numbers_[at + i];
      const Meaning& meaning = table_->columns[column].meaning;
      if (meaning.axis_named) named[*meaning.axis] = static_cast<int>(column);
      ordered[i] = static_cast<int>(column);
    }
    return count_of(named) == axes ? named : ordered;
  }

  /// The lines without numbers, and single ones with some, speak of rates alone.
  bool is_headed_by_rates() {
    const bool has_names = std::any_of(numbers_.begin(), numbers_.end(), [&](std::size_t column) {
      return table_->columns[column].meaning.quantity != Quantity::none;
    });
    if (has_names) return false;  // a header that names other things
    const auto read = [&](const std::string& line) {
      if (!holds_doubt(line)) above_.words(line);
    };
    for (const std::string& heading : page_.headings) read(heading);
    for (const TextTable& table : page_.tables)
      if (&table != table_ && !is_enough(table)) read(table.sample_line);
    constexpr std::array others{Quantity::acceleration, Quantity::magnetic, Quantity::angle,
                                Quantity::quaternion};
    return above_.has_named(Quantity::rate) &&
           std::none_of(others.begin(), others.end(),
                        [&](Quantity other) { return above_.has_named(other); });
  }

  bool is_of_other_things() {
    for (const TextTable& table : page_.tables)
      if (is_enough(table))
        for (const TextColumn& column : table.columns) note(column.meaning.quantity);
    if (is_on_page(angles_of_bno055)) note(Quantity::angle);
    return !others_.empty();
  }
  void note(Quantity quantity) {
    constexpr std::array others{Quantity::acceleration, Quantity::magnetic, Quantity::angle,
                                Quantity::quaternion};
    if (std::find(others.begin(), others.end(), quantity) == others.end()) return;
    if (std::find(others_.begin(), others_.end(), quantity) == others_.end()) others_.push_back(quantity);
  }

  TextFormat refuse_other_things() {
    begin(*most_frequent());
    std::string words;
    for (const Quantity quantity : others_)
      words += (words.empty() ? "" : " and ") + std::string(name_of(quantity));
    format_.refusal = fmt::format("its lines hold {}, no rates of turn", words);
    format_.advice =
        "make the sketch print the gyro's x, y, z (its rates in deg/s): an angle is what some filter made of "
        "them";
    return format_;
  }

  TextFormat refuse(std::string why, std::string advice) {
    if (const TextTable* table = most_frequent()) begin(*table);
    format_.refusal = std::move(why);
    format_.advice = std::move(advice);
    return format_;
  }

  void find_time() {
    const auto is_free = [&](std::size_t column) {
      const auto& rate = format_.columns.rate;
      return !format_.rates_known ||
             std::find(rate.begin(), rate.end(), static_cast<int>(column)) == rate.end();
    };
    const auto clock = [&](bool named) {
      return std::find_if(numbers_.begin(), numbers_.end(), [&](std::size_t column) {
        const Quantity quantity = table_->columns[column].meaning.quantity;
        return is_free(column) && quantity == (named ? Quantity::time : Quantity::none) &&
               (named ? !has_odd_unit(table_->columns[column].name) : column == numbers_.front()) &&
               runs_like_a_clock(*table_, column, named);
      });
    };
    auto time = clock(true);
    if (time == numbers_.end()) time = clock(false);
    if (time == numbers_.end() || (numbers_.size() == axes && !format_.rates_known)) return;
    const double unit_s =
        named_time_unit_s(table_->columns[*time].name).value_or(unit_of_clock(*table_, *time, heard_s_));
    format_.columns.time = static_cast<int>(*time);
    format_.columns.time_unit_s = unit_s;
    say(fmt::format("column {} runs like a clock, in {}", *time, unit_text(unit_s)));
    numbers_.erase(time);
  }

  void take_rates(const Rates& rates) {
    format_.columns.rate = rates;
    format_.rates_known = true;
  }

  void take_scale(double scale_dps, std::string why) {
    format_.columns.scale_dps = scale_dps;
    format_.scale_known = true;
    say(std::move(why));
  }

  /// `words` stand where a unit does.
  void leave_scale_open(const std::string& words = "") {
    const auto& rates = format_.columns.rate;
    format_.is_counts = std::all_of(rates.begin(), rates.end(), [&](int column) {
      return column < 0 || table_->columns[static_cast<std::size_t>(column)].decimals == 0;
    });
    format_.columns.scale_dps = format_.is_counts ? 1.0 / mpu6050_counts_per_dps : 1.0;
    say(words.empty()
            ? "their unit is not given"
            : fmt::format(
                  "\"{}\" does not name their unit clearly: it may have a factor, or be the unit of an angle",
                  words));
  }

  void say_one_axis() {
    std::string others;
    for (const TextTable& table : page_.tables)
      if (&table != table_ && is_enough(table) && count_of(named_rates(table)) > 0)
        others += fmt::format("{}\"{}\"", others.empty() ? "" : " or ", longest_prefix(table));
    say("no line has every axis: lines of the other axes are not read" +
        (others.empty() ? "" : "; to read others instead, set prefix = " + others));
  }

  TextFormat finish() {
    name_sketch();
    remark_on_rest();
    remark_on_sums();
    add_remark_on_resolution();
    if (reads_other_lines()) format_.columns.prefix = longest_prefix(*table_);
    if (table_->sample_line.size() > text_line_bytes_max) {
      format_.refusal = fmt::format("its lines have {} bytes, the limit is {}", table_->sample_line.size(),
                                    text_line_bytes_max);
      format_.advice = "print fewer columns";
    } else if (has_unsigned_counts()) {
      format_.refusal = "its counts have lost their sign (65535 for -1)";
      format_.advice = "keep them in an int16_t before they are printed";
    } else if (const std::string sensors = several_sensors(); !sensors.empty()) {
      format_.refusal = fmt::format("its lines come from several sensors ({})", sensors);
      format_.advice = "print only one";
    } else if (changes_unit()) {
      format_.refusal = "the unit on its lines changes";
      format_.advice = "print one unit, or give decode the part of the file that has it";
    } else if (reads_other_lines() || is_told_by_headings()) {
      format_.refusal = "lines of rates and lines of other values begin alike";
      format_.advice = "print one line a sample, or a word at the start of each kind of line";
    }
    return format_;
  }

  /// Whole numbers of 16 bits that are never negative, and lie near both ends.
  bool has_unsigned_counts() const {
    if (format_.scale_known && !format_.is_counts) return false;
    bool is_large = false;
    for (const int column : format_.columns.rate) {
      if (column < 0) continue;
      for (const auto& row : table_->rows) {
        const double number = row[static_cast<std::size_t>(column)];
        if (number < 0 || number != std::trunc(number) || number > 65535) return false;
        is_large |= number > 32767;
      }
    }
    return is_large;
  }

  /// "imu is 1, 2"; empty: of one.
  std::string several_sensors() const {
    for (std::size_t column = 0; column < table_->columns.size(); ++column) {
      const auto& rates = format_.columns.rate;  // "IMU: 0 -1 2": the first rate stands behind that word
      if (std::find(rates.begin(), rates.end(), static_cast<int>(column)) != rates.end()) continue;
      std::set<double> numbers;
      if (names_sensors(*table_, column, numbers))
        return fmt::format("\"{}\" is {:g}", table_->columns[column].name, fmt::join(numbers, ", "));
    }
    return "";
  }

  /// Lines that would be read alike say another unit.
  bool changes_unit() const {
    if (!format_.rates_known) return false;
    const double scale_dps = scale_of(*table_, format_.columns.rate);
    return std::any_of(page_.tables.begin(), page_.tables.end(), [&](const TextTable& table) {
      return table.prefix == table_->prefix && named_rates(table) == format_.columns.rate &&
             is_enough(table) && scale_dps > 0.0 && scale_of(table, format_.columns.rate) > 0.0 &&
             scale_of(table, format_.columns.rate) != scale_dps;
    });
  }

  /// Two sorts of lines would pass for samples.
  bool reads_other_lines() const {
    std::string room;
    return std::any_of(page_.tables.begin(), page_.tables.end(), [&](const TextTable& table) {
      const bool is_rare = 10 * table.rows.size() < table_->rows.size();  // damaged ones
      if (is_rare || &table == table_) return false;
      const TextLine line = read_text_line(format_.columns, table.sample_line, room);
      return line.reading && named_rates(table) != named_rates(*table_);
    });
  }

  /// The first column's name is taken in: "gx:" of lines that also begin with "ax:".
  static std::string longest_prefix(const TextTable& table) {
    const std::string_view line = table.sample_line;
    const std::size_t at = std::min(line.find_first_not_of(" \t"), line.size());
    const auto first = Fields(line).next();
    if (!table.prefix.empty() || !first || first->name.empty()) return table.prefix;
    return std::string(line.substr(at, static_cast<std::size_t>(first->value.data() - line.data()) - at));
  }

  /// Headings, not words on the lines, tell what bare lines hold.
  bool is_told_by_headings() const {
    return !format_.rates_known && 2 * page_.heading_lines >= table_->rows.size() &&
           page_.headings.size() > 1 && page_.rows >= rows_of_a_rest;
  }

  /// Whose lines they are: a mark alone may stand on lines of another one.
  void name_sketch() {
    if (!format_.rates_known || !format_.scale_known) return;
    for (const GyroSketch& sketch : gyro_sketches()) {
      if (sketch.name.empty() || sketch.mark.empty() || !is_on_page(sketch.mark)) continue;
      GyroProfile profile{.sketch = std::string(sketch.name), .text = sketch.columns};
      std::string room;
      if (!read_text_line(sketch.columns, format_.sample_line, room).reading) continue;
      if (!contradiction(profile, format_).empty()) continue;
      format_.sketch = sketch.name;
      say(fmt::format("this is how {} prints ({})", sketch.title, sketch.name));
      if (!sketch.remark.empty())
        format_.remarks.push_back(fmt::format("{}: {}", sketch.title, sketch.remark));
      return;
    }
  }

  void remark_on_rest() {
    if (table_->rows.size() < rows_of_a_rest) return;
    const auto& rates = format_.columns.rate;
    if (!std::all_of(rates.begin(), rates.end(), [&](int column) {
          return column < 0 || is_constant(*table_, static_cast<std::size_t>(column));
        }))
      return;
    const double value = table_->rows.front()[static_cast<std::size_t>(first_rate())];
    format_.remarks.push_back(fmt::format(
        "the rates never change ({:g} in {} lines): is the sensor connected? Check its wires and its address",
        value, table_->rows.size()));
  }

  void remark_on_sums() {
    if (page_.with_sums < rows_of_a_rest || 4 * page_.with_right_sums > page_.with_sums) return;
    format_.remarks.emplace_back(
        "its lines end with a sum (*hh) that is neither the XOR nor the sum of their characters: they are "
        "read unchecked, damaged ones as well");
  }

  void add_remark_on_resolution() {
    if (!format_.scale_known || format_.is_counts) return;
    const std::size_t decimals = table_->columns[static_cast<std::size_t>(first_rate())].decimals;
    std::string remark = remark_on_resolution(decimals, format_.columns.scale_dps);
    if (!remark.empty()) format_.remarks.push_back(std::move(remark));
  }

  int first_rate() const { return first_of(format_.columns.rate); }

  std::string columns_text() const {
    const auto& rate = format_.columns.rate;
    return fmt::format("columns {},{},{}", rate[0], rate[1], rate[2]);
  }

  void say(std::string sentence) { format_.assumptions.push_back(std::move(sentence)); }

  const TextPage& page_;
  double heard_s_;
  const TextTable* table_ = nullptr;
  std::vector<std::size_t> numbers_;  // columns that may be rates
  WordReader above_;
  std::vector<Quantity> others_;  // that are named where no rates are
  TextFormat format_;
};

}  // namespace

std::string open_question(const TextFormat& format) {
  if (!format.refusal.empty() || format.is_known()) return "";
  const char* const unit = format.is_counts
                               ? "how many counts are a deg/s (131, 65.5, 32.8, 16.4 by its range)"
                               : "in which unit they are (deg/s, rad/s)";
  if (format.rates_known) return fmt::format("the columns of the rates are known, but not {}", unit);
  return fmt::format("the lines do not say which columns are the rates, or {}", unit);
}

std::optional<TextFormat> guess_text_format(std::span<const std::uint8_t> bytes, StreamStart start,
                                            double heard_s) {
  const TextPage page = read_page(bytes, start);
  return Recogniser(page, heard_s).format();
}

}  // namespace thermorig::sensors
