// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "thermorig/core/nearest_name.h"
#include "thermorig/sensors/gyro_protocol.h"
#include "thermorig/storage/recording_header/profile_fields.h"

namespace thermorig::recording_header {

namespace {

using Problem = std::optional<ProfileProblem>;

ProfileProblem problem_with(const ProfileField& field, const std::string& what, const std::string& allowed) {
  return {field.table, field.name, what, allowed};
}

/// "2026-07-25", or the same with a time of day behind it: ISO 8601 in UTC.
bool is_date(const std::string& text) {
  constexpr std::string_view day = "dddd-dd-dd";
  constexpr std::string_view allowed_after = "0123456789T:.Z";
  if (text.size() < day.size() || text.size() > 32) return false;
  for (std::size_t i = 0; i < day.size(); ++i)
    if (day[i] == 'd' ? text[i] < '0' || text[i] > '9' : text[i] != day[i]) return false;
  return text.find_first_not_of(allowed_after, day.size()) == std::string::npos;
}

template <typename Number>
Problem problem_of_number(const ProfileField& field, Number value, const char* kind) {
  const auto number = static_cast<double>(value);
  // A value that is no number is not within anything.
  if (number >= field.min && number <= field.max) return std::nullopt;
  return problem_with(field, fmt::format("{} = {} is out of range", field.name, value),
                      fmt::format("{} from {} to {}", kind, field.min, field.max));
}

Problem problem_of_text(const ProfileField& field, const std::string& text) {
  if (field.is_date && !text.empty() && !is_date(text))
    return problem_with(field, fmt::format("{} = \"{}\" is not a date", field.name, text),
                        "UTC as in \"2026-07-25T14:35:12Z\", or \"\" for an assumption");
  if (!field.words.empty() && std::find(field.words.begin(), field.words.end(), text) == field.words.end())
    return problem_with(field, fmt::format("{} = \"{}\" is not known", field.name, text),
                        advice_on_name(text, field.words));
  if (text.find('\0') != std::string::npos)
    return problem_with(field, field.name + " holds a zero byte", "text without one");
  return std::nullopt;
}

/// Whether the value alone is allowed.
Problem problem_of_value(const ProfileField& field, const FieldValue& value) {
  if (value.index() != field.standard.index())
    return problem_with(field, field.name + " is not a whole number", "a whole number");
  if (const auto* const number = std::get_if<double>(&value))
    return problem_of_number(field, *number, "a number");
  if (const auto* const whole = std::get_if<std::int64_t>(&value))
    return problem_of_number(field, *whole, "a whole number");
  if (const auto* const text = std::get_if<std::string>(&value)) return problem_of_text(field, *text);
  return std::nullopt;
}

/// Whether values that are allowed go together.
Problem problem_of_all(const RigProfile& profile) {
  if (profile.gyro.sign == 0) return ProfileProblem{"gyro", "sign", "sign = 0 is out of range", "1 or -1"};
  if (profile.encoder.sign == 0)
    return ProfileProblem{"encoder", "sign", "sign = 0 is out of range", "1 or -1"};
  const sensors::GyroProtocol* const protocol = sensors::find_gyro_protocol(profile.gyro.protocol);
  if (!profile.gyro.sketch.empty() && protocol != nullptr && !protocol->has_columns)
    return ProfileProblem{"gyro", "sketch", "a sketch is named, but the protocol is " + profile.gyro.protocol,
                          "protocol = \"text\", or no sketch"};
  const ServoProfile& servo = profile.servo;
  if (!servo.is_there()) return std::nullopt;
  if (servo.pulse_min_us >= servo.pulse_max_us)
    return ProfileProblem{"servo", "pulse_min_us", "pulse_min_us is not below pulse_max_us",
                          "e.g. 500 and 2500"};
  if (servo.kind == ServoKind::continuous && servo.full_rate_dps <= 0.0)
    return ProfileProblem{"servo", "kind", "a continuous servo needs full_rate_dps",
                          "its speed at the longest pulse, e.g. 250"};
  const bool has_limits = servo.kind == ServoKind::positional || servo.travel_deg > 0.0;
  if (has_limits && servo.travel_deg - 2.0 * servo.stop_margin_deg < 1.0)
    return ProfileProblem{"servo", "stop_margin_deg", "the margins leave no travel",
                          "stop_margin_deg below half of travel_deg"};
  return std::nullopt;
}

Problem problem_of_settings(const GyroProfile& gyro) {
  const std::vector<ProfileField> known = setting_fields(gyro.protocol);
  for (const auto& setting : gyro.settings) {
    const std::string& name = setting.first;
    const auto is_it = [&](const ProfileField& field) { return field.name == name; };
    if (std::none_of(known.begin(), known.end(), is_it))
      return ProfileProblem{"gyro." + gyro.protocol, name, name + " is not one of its settings",
                            "those that the protocol has"};
  }
  return std::nullopt;
}

}  // namespace

std::string ProfileProblem::text() const {
  return fmt::format("{}{}: {}", table.empty() ? "" : "[" + table + "] ", what, allowed);
}

std::optional<ProfileProblem> problem_of(const RigProfile& profile) {
  Problem found;
  for_each_field(profile, [&](const ProfileField& field, const FieldValue& value) {
    if (!found) found = problem_of_value(field, value);
  });
  if (!found) found = problem_of_settings(profile.gyro);
  return found ? found : problem_of_all(profile);
}

RigProfile profile_from(const std::function<std::optional<FieldValue>(const ProfileField& field)>& find,
                        const std::function<void(const ProfileProblem& problem)>& refuse) {
  RigProfile profile;
  const auto take = [&](const ProfileField& field) {
    const std::optional<FieldValue> value = find(field);
    if (!value) return;
    if (const Problem problem = problem_of_value(field, *value)) refuse(*problem);
    field.set(profile, *value);
  };
  for (const ProfileField& field : profile_fields()) take(field);
  for (const ProfileField& field : setting_fields(profile.gyro.protocol)) take(field);
  if (const Problem problem = problem_of_all(profile)) refuse(*problem);
  return profile;
}

}  // namespace thermorig::recording_header
