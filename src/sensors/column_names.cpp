// SPDX-License-Identifier: MIT
#include "column_names.h"

#include <algorithm>
#include <numbers>
#include <string_view>

namespace thermorig::sensors {

namespace {

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

}  // namespace

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

std::optional<double> named_time_unit_s(const std::string& name) {
  const std::string text = lower(name);
  if (has_any_word(text, {"us", "micros"})) return 1e-6;
  if (has_any_word(text, {"ms", "millis"})) return 1e-3;
  if (has_any_word(text, {"s", "sec", "seconds"})) return 1.0;
  return std::nullopt;
}

}  // namespace thermorig::sensors
