// SPDX-License-Identifier: MIT
#pragma once

#include <fmt/format.h>

#include <string>

#include "thermorig/storage/recording_header/profile_fields.h"

namespace thermorig::tests {

/// Allowed, not the standard one, and different for each index; higher for higher ones.
inline recording_header::FieldValue unusual_value(const recording_header::ProfileField& field,
                                                  std::size_t index) {
  const auto share = 0.1 + 0.008 * static_cast<double>(index);
  if (std::holds_alternative<double>(field.standard)) return field.min + share * (field.max - field.min);
  if (const auto* const flag = std::get_if<bool>(&field.standard)) return !*flag;
  if (field.name == "sign") return std::int64_t{-1};
  if (std::holds_alternative<std::int64_t>(field.standard))
    return static_cast<std::int64_t>(field.min + share * (field.max - field.min));
  if (field.is_date) return fmt::format("2026-07-25T{:02}:{:02}:00Z", index / 60, index % 60);
  if (field.name == "sketch") return std::string();  // it goes with one protocol alone, which has no settings
  if (field.table == "gyro" && field.name == "protocol") return std::string("mavlink");  // which has settings
  if (field.words.empty()) return fmt::format("text {} \"früh\" \\ \t", index);
  const bool last_is_standard = std::get<std::string>(field.standard) == field.words.back();
  return last_is_standard ? field.words.front() : field.words.back();
}

/// A profile in which no field but the sketch has its standard value.
inline RigProfile unusual_profile() {
  RigProfile profile;
  std::size_t index = 0;
  for (const auto& field : recording_header::profile_fields())
    field.set(profile, unusual_value(field, index++));
  for (const auto& field : recording_header::setting_fields(profile.gyro.protocol))
    field.set(profile, unusual_value(field, index++));
  return profile;
}

/// Names of the fields that differ, with their tables; empty: the profiles are the same.
inline std::string difference(const RigProfile& a, const RigProfile& b) {
  std::string names;
  recording_header::for_each_field(a, [&](const auto& field, const auto& value) {
    if (field.get(b) != value) names += fmt::format("{}.{} ", field.table, field.name);
  });
  return names;
}

}  // namespace thermorig::tests
