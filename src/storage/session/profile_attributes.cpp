// SPDX-License-Identifier: MIT
#include "profile_attributes.h"

#include <cstdint>
#include <optional>
#include <string>

#include "attributes.h"
#include "group_reader.h"
#include "thermorig/storage/recording_header/profile_fields.h"
#include "thermorig/storage/session/stored_file.h"

namespace thermorig::session {

namespace {

using recording_header::FieldValue;
using recording_header::ProfileField;
using recording_header::ProfileProblem;

/// "/rig/profile/gyro/text" of "gyro.text".
std::string group_of_table(const std::string& table) {
  std::string path = profile_group;
  if (!table.empty()) path += "/" + table;
  for (char& character : path)
    if (character == '.') character = '/';
  return path;
}

void set_value(hid_t group, const std::string& name, const FieldValue& value) {
  const auto set = [&](const auto& known) { set_attribute(group, name.c_str(), known); };
  if (const auto* const flag = std::get_if<bool>(&value))
    set(static_cast<std::uint8_t>(*flag ? 1 : 0));
  else if (const auto* const whole = std::get_if<std::int64_t>(&value))
    set(*whole);
  else if (const auto* const number = std::get_if<double>(&value))
    set(*number);
  else
    set(std::get<std::string>(value));
}

std::optional<FieldValue> value_in(hid_t file, const ProfileField& field) {
  const std::string path = group_of_table(field.table);
  if (check(H5Lexists(file, path.c_str(), H5P_DEFAULT), "look for " + path) == 0) return std::nullopt;
  const GroupReader group(file, path, {});
  const char* const name = field.name.c_str();
  if (!has_attribute(group.id(), name)) return std::nullopt;
  if (std::holds_alternative<bool>(field.standard)) return get_attribute<std::uint8_t>(group.id(), name) != 0;
  if (std::holds_alternative<std::int64_t>(field.standard))
    return get_attribute<std::int64_t>(group.id(), name);
  if (std::holds_alternative<double>(field.standard)) return get_attribute<double>(group.id(), name);
  return get_text_attribute(group.id(), name);
}

}  // namespace

void write_profile(const std::function<GroupWriter(const std::string& path)>& make_group,
                   const RigProfile& profile) {
  std::string table;
  std::optional<GroupWriter> group(make_group(profile_group));
  recording_header::for_each_field(profile, [&](const ProfileField& field, const FieldValue& value) {
    if (field.table != table) group.emplace(make_group(group_of_table(field.table)));
    table = field.table;
    set_value(group->id(), field.name, value);
  });
}

RigProfile read_profile(hid_t file, const std::filesystem::path& path) {
  const GroupReader must_be_there(file, profile_group, {});
  return recording_header::profile_from([&](const ProfileField& field) { return value_in(file, field); },
                                        [&](const ProfileProblem& problem) {
                                          refuse(path, "its profile cannot be believed: " + problem.text());
                                        });
}

}  // namespace thermorig::session
