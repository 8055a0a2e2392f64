// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/sensors/text_format.h"

namespace thermorig::sensors {

/// A published sketch or firmware that prints a gyro's rates as text. Source: protocols/text_gyro.md.
struct GyroSketch {
  std::string_view name;    // in profiles (`sketch`) and `--gyro-protocol`; empty: it is only recognised
  std::string_view title;   // "Adafruit_MPU6050, basic_readings"
  std::string_view prints;  // what one unit is: "rad/s"
  TextColumns columns;      // as it is published
  std::uint32_t baud = 115200;
  double rate_hz = 0.0;          // lines a second, as it is published
  double bandwidth_hz = 0.0;     // of the low-pass that it sets; 0: it sets none
  std::size_t decimals = 0;      // of its numbers; 0: none, or none that are too few
  std::string_view remark = {};  // what is to be known of its rates; empty: nothing

  // How its lines are known, by what only they hold. Empty: no word tells them.
  std::string_view mark = {};
  bool mark_tells_unit = false;  // as no word does
  int first_number = -1;         // from which the rates are, without a name; -1: they have names
  double gravity = 0.0;          // what its accelerations measure; 0: they are not on the line
};

std::span<const GyroSketch> gyro_sketches();

/// Nothing if there is none of that name.
const GyroSketch* find_gyro_sketch(std::string_view name);

/// Of protocols and sketches, which an option may name alike.
std::vector<std::string> gyro_names();

/// Makes it a gyro of that protocol or sketch, as it comes: columns, rate and, of a sketch, baud rate. Throws
/// Error(bad_usage) if there is none of that name: it lists those there are.
void choose_gyro(std::string_view name, GyroProfile& profile);

/// Why the lines are not those of the profile's sketch, as their own words tell; empty: they may be. Who has
/// changed the sketch's columns in the profile is believed.
std::string contradiction(const GyroProfile& profile, const TextFormat& format);

/// What so few decimals cost, in units of so many deg/s; empty: nothing.
std::string remark_on_resolution(std::size_t decimals, double scale_dps);

/// What is to be known of the rates of such a gyro, ready to print; empty: nothing.
std::string remark_on_rates(const GyroProfile& profile);

}  // namespace thermorig::sensors
