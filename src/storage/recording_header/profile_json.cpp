// SPDX-License-Identifier: MIT
#include "profile_json.h"

#include <array>
#include <cmath>
#include <stdexcept>

#include "thermorig/storage/recording_header/profile_fields.h"

namespace thermorig::recording_header {

namespace {

using nlohmann::json;

/// "/gyro/text" of "gyro.text".
json::json_pointer place_of(const std::string& table) {
  std::string place = table.empty() ? "" : "/" + table;
  for (char& character : place)
    if (character == '.') character = '/';
  return json::json_pointer(place);
}

std::optional<FieldValue> value_in(const json& tables, const ProfileField& field) {
  const json::json_pointer place = place_of(field.table) / field.name;
  if (!tables.contains(place)) return std::nullopt;
  const json& value = tables.at(place);
  if (std::holds_alternative<std::int64_t>(field.standard)) return whole_number<std::int64_t>(value);
  return std::visit([&](const auto& like) -> FieldValue { return value.get<std::decay_t<decltype(like)>>(); },
                    field.standard);
}

// Before session format 2.0 the keys were those of the structures in memory: what belongs to a port in
// "link", columns of text in an array, the gyro's axis as its index, settings of whatever protocol in
// "settings".

void move_link_into(json& device) {
  const json link = device.at("link");
  device.erase("link");
  device.update(link);
}

void name_columns(json& text) {
  const json rate = text.at("rate");
  text["x_column"] = rate.at(0);
  text["y_column"] = rate.at(1);
  text["z_column"] = rate.at(2);
  text["time_column"] = text.at("time");
}

void name_axis(json& gyro) {
  constexpr std::array words{"x", "y", "z"};
  const auto axis = whole_number<std::uint64_t>(gyro.at("axis"));
  if (axis >= words.size()) throw std::out_of_range("the gyro's axis is none of 0, 1 and 2");
  gyro["axis"] = words[axis];
}

/// They were all stored as numbers with a fraction.
void move_settings(json& gyro) {
  if (!gyro.contains("settings")) return;
  json& settings = gyro[gyro.at("protocol").get<std::string>()];
  for (const auto& [name, value] : gyro.at("settings").items()) {
    const auto number = value.get<double>();
    settings[name] = number == std::trunc(number) && std::abs(number) < 1e15
                         ? json(static_cast<std::int64_t>(number))
                         : json(number);
  }
}

bool is_of_format_1(const json& profile) {
  return profile.at("camera").contains("link");
}

json of_format_2(json profile) {
  for (const char* device : {"camera", "gyro", "servo"}) move_link_into(profile.at(device));
  json& gyro = profile.at("gyro");
  name_columns(gyro.at("text"));
  name_axis(gyro);
  move_settings(gyro);
  return profile;
}

}  // namespace

json profile_to_json(const RigProfile& profile) {
  json tables = json::object();
  for_each_field(profile, [&](const ProfileField& field, const FieldValue& value) {
    std::visit([&](const auto& known) { tables[place_of(field.table)][field.name] = known; }, value);
  });
  return tables;
}

RigProfile profile_from_json(const json& in) {
  const json tables = is_of_format_1(in) ? of_format_2(in) : in;
  return profile_from(
      [&](const ProfileField& field) { return value_in(tables, field); },
      [](const ProfileProblem& problem) { throw std::out_of_range("the profile's " + problem.text()); });
}

}  // namespace thermorig::recording_header
