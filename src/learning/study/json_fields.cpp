// SPDX-License-Identifier: MIT
#include "json_fields.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "thermorig/core/error.h"

namespace thermorig::study {

namespace {

using nlohmann::json;

constexpr std::size_t max_text = 4'000'000;  // a result is below 20 kB; a model tested on hundreds is not one
constexpr int max_depth = 8;
constexpr std::uint64_t max_count = std::uint64_t{1} << 53;  // window counts add up without overflow

[[noreturn]] void refuse_file(const std::string& what, const std::string& where) {
  throw Error(ExitCode::not_a_session, "this is no sound result of a study: " + what, where,
              "delete it and run the study again: only this job is then repeated");
}

}  // namespace

json parsed(const std::string& text, const std::string& where) {
  if (text.size() > max_text) refuse_file("it is far too long", where);
  const auto not_too_deep = [](int depth, json::parse_event_t, json&) {
    return depth <= max_depth;  // what lies deeper is dropped while it is read
  };
  json object = json::parse(text, not_too_deep, false);
  if (object.is_discarded() || !object.is_object()) refuse_file("it is not a JSON object", where);
  return object;
}

Fields::Fields(const json& object, std::string where, std::string prefix)
    : object_(&object), where_(std::move(where)), prefix_(std::move(prefix)) {
  if (!object.is_object()) refuse_file(fmt::format("{} is no object", prefix_), where_);
}

void Fields::refuse(const std::string& field, const std::string& what) const {
  refuse_file(fmt::format("{}{} {}", prefix_, field, what), where_);
}

const json& Fields::at(const char* field) const {
  const auto found = object_->find(field);
  if (found == object_->end()) refuse(field, "is missing");
  return *found;
}

const json& Fields::list(const char* field) const {
  const json& value = at(field);
  if (!value.is_array()) refuse(field, "is no list");
  return value;
}

double Fields::number_of(const json& value, const char* field) const {
  if (value.is_null()) return std::numeric_limits<double>::quiet_NaN();
  if (!value.is_number()) refuse(field, "is no number");
  const double number = value.get<double>();
  if (!std::isfinite(number)) refuse(field, "is out of range");
  return number;
}

std::uint64_t Fields::count_of(const json& value, const char* field) const {
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() > max_count) refuse(field, "is no count");
  return value.get<std::uint64_t>();
}

int Fields::integer(const char* field, int low, int high) const {
  const json& value = at(field);
  if (!value.is_number_integer()) refuse(field, "is no whole number");
  const std::int64_t number = value.get<std::int64_t>();
  if (number < low || number > high) refuse(field, fmt::format("is not within {}..{}", low, high));
  return static_cast<int>(number);
}

std::uint64_t Fields::count(const char* field) const {
  return count_of(at(field), field);
}

std::uint64_t Fields::seed(const char* field) const {
  const json& value = at(field);
  if (!value.is_number_unsigned()) refuse(field, "is no seed");
  return value.get<std::uint64_t>();
}

double Fields::number(const char* field) const {
  return number_of(at(field), field);
}

double Fields::within(double number, double low, double high, const char* field) const {
  if (number < low || number > high) refuse(field, fmt::format("is {}, which cannot be", number));
  return number;
}

double Fields::number(const char* field, double low, double high) const {
  return within(number(field), low, high, field);
}

double Fields::magnitude(const char* field) const {
  return number(field, 0.0, std::numeric_limits<double>::max());
}

std::vector<double> Fields::magnitudes(const char* field) const {
  std::vector<double> magnitudes = numbers(field);
  for (const double value : magnitudes) within(value, 0.0, std::numeric_limits<double>::max(), field);
  return magnitudes;
}

bool Fields::truth(const char* field) const {
  const json& value = at(field);
  if (!value.is_boolean()) refuse(field, "is neither true nor false");
  return value.get<bool>();
}

std::string Fields::text(const char* field) const {
  const json& value = at(field);
  if (!value.is_string()) refuse(field, "is no text");
  return value.get<std::string>();
}

std::vector<double> Fields::numbers(const char* field) const {
  std::vector<double> numbers;
  for (const json& value : list(field)) numbers.push_back(number_of(value, field));
  return numbers;
}

std::vector<std::vector<double>> Fields::rows(const char* field, std::size_t count) const {
  const json& values = list(field);
  if (values.size() != count) refuse(field, "has another length");
  std::vector<std::vector<double>> rows(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (!values[i].is_array()) refuse(field, "is no list of lists");
    for (const json& value : values[i]) rows[i].push_back(number_of(value, field));
  }
  return rows;
}

std::vector<std::string> Fields::texts(const char* field) const {
  std::vector<std::string> texts;
  for (const json& value : list(field)) {
    if (!value.is_string()) refuse(field, "holds what is no text");
    texts.push_back(value.get<std::string>());
  }
  return texts;
}

Fields Fields::object(const char* field) const {
  return {at(field), where_, fmt::format("{}{}.", prefix_, field)};
}

std::vector<Fields> Fields::objects(const char* field) const {
  std::vector<Fields> objects;
  for (const json& value : list(field))
    objects.emplace_back(value, where_, fmt::format("{}{}[{}].", prefix_, field, objects.size()));
  return objects;
}

}  // namespace thermorig::study
