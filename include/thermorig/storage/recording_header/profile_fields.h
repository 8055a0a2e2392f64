// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "thermorig/core/profile.h"

namespace thermorig::recording_header {

/// A value in the form that it has outside of the program. A choice is one of its words.
using FieldValue = std::variant<bool, std::int64_t, double, std::string>;

/// One field of the rig profile: all that its forms (TOML, JSON of journals, attributes of sessions) and its
/// checks have to know of it.
struct ProfileField {
  std::string table;  // of the TOML file: "" for the root, "camera", "gyro.text"
  std::string name;   // in that table; ends with the unit
  std::string unit;   // "" of what is no number, and of settings
  std::string help;
  FieldValue standard;             // where the profile does not say otherwise; its type is the field's type
  double min = 0.0, max = 0.0;     // of a number, both allowed
  std::vector<std::string> words;  // the only texts allowed; empty: any without a zero byte
  bool is_date = false;            // text that is empty or "2026-07-25", or that with a time behind it, UTC

  std::function<FieldValue(const RigProfile&)> get;
  /// The value is of the field's type and allowed.
  std::function<void(RigProfile&, const FieldValue&)> set;
};

/// Every field once, but for the settings of the gyro's protocol. The list that all others walk.
const std::vector<ProfileField>& profile_fields();

/// The fields of table "gyro.<protocol>": the protocol's settings. None if there is no such protocol.
std::vector<ProfileField> setting_fields(const std::string& protocol);

/// Calls use(field, value) for all fields of the profile, the settings of its gyro's protocol last.
void for_each_field(const RigProfile& profile,
                    const std::function<void(const ProfileField& field, const FieldValue& value)>& use);

/// Why a profile cannot be used: the value of one field.
struct ProfileProblem {
  std::string table, name;  // of the field
  std::string what;         // "latency_s = 20 is out of range"
  std::string allowed;      // "a number from -0.1 to 1"

  std::string text() const;  // both, with the table
};

/// Nothing if every value is allowed, and all of them together describe a rig.
std::optional<ProfileProblem> problem_of(const RigProfile& profile);

/// A profile of what `find` knows of each field: a value of the field's type, in range or not, or nothing,
/// which stands for the standard value. Of what is not allowed the first is given to `refuse`, which throws.
RigProfile profile_from(const std::function<std::optional<FieldValue>(const ProfileField& field)>& find,
                        const std::function<void(const ProfileProblem& problem)>& refuse);

}  // namespace thermorig::recording_header
