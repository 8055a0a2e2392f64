// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <concepts>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "fingerprint.h"
#include "thermorig/core/error.h"
#include "thermorig/learning/study/result_fields.h"
#include "thermorig/learning/study/study.h"

namespace thermorig::study {

namespace {

using nlohmann::json;

constexpr const char* format_name = "thermorig study result";
constexpr int format_version = 5;
constexpr int with_sum = 5;
constexpr std::size_t max_text = 4'000'000;  // a result is below 20 kB
constexpr int max_depth = 8;
constexpr std::uint64_t max_count = std::uint64_t{1} << 53;  // window counts add up without overflow

constexpr std::array<std::pair<std::string_view, std::string_view>, 3> names_before_version_2{
    {{"thermal", thermal_name}, {"fusion", fusion_name}, {"gyro_unbiased", "gyro-rest"}}};

/// Reads what FieldWriter writes. Throws std::out_of_range, with the field's name, for what is missing, of
/// another kind or of another length.
class FieldReader {
 public:
  FieldReader(const json& object, int version, std::vector<std::string> names)
      : object_(object), version_(version), names_(std::move(names)) {}

  bool has(int version) const { return version_ >= version; }

  template <typename Value>
  void operator()(const char* key, Value& value) const {
    try {
      const auto found = object_.find(key);
      if (found == object_.end()) throw std::out_of_range("is missing");
      read(*found, value);
    } catch (const std::exception& error) {
      throw std::out_of_range(fmt::format("{}: {}", key, error.what()));
    }
  }

 private:
  static void read(const json& in, Label& label) {
    const auto found = find_label(in.get<std::string>());
    if (!found) throw std::out_of_range("is not known here");
    label = *found;
  }
  static void read(const json& in, double& value) {
    value = in.is_null() ? std::numeric_limits<double>::quiet_NaN() : in.get<double>();
  }
  template <std::integral Value>
  static void read(const json& in, Value& value) {
    if constexpr (std::is_same_v<Value, bool>) {
      value = in.get<bool>();
    } else {
      if (!in.is_number_integer() || (std::is_unsigned_v<Value> && !in.is_number_unsigned()))
        throw std::out_of_range(in.dump() + " is no count");
      value = in.get<Value>();
    }
  }
  static void read(const json& in, std::string& value) { in.get_to(value); }
  template <typename Value>
  void read(const json& in, std::vector<Value>& values) const {
    if (!in.is_array()) throw std::out_of_range("what should be a list is none");
    values.assign(in.size(), Value());
    for (std::size_t i = 0; i < in.size(); ++i) read(in[i], values[i]);
  }
  template <std::size_t N>
  void read(const json& in, std::array<std::uint64_t, N>& values) const {
    if (in.size() != N) throw std::out_of_range("a list has another length");
    for (std::size_t i = 0; i < N; ++i) read(in.at(i), values[i]);
  }
  /// What the file says of the estimators that there are today.
  template <typename Value>
  void read(const json& in, PerEstimator<Value>& placed) const {
    std::vector<Value> values;
    read(in, values);
    if (values.size() != names_.size()) throw std::out_of_range("a list over estimators has another length");
    for (std::size_t i = 0; i < names_.size(); ++i)
      if (is_estimator(names_[i])) placed[names_[i]] = std::move(values[i]);
  }
  template <typename Struct>
  void read(const json& in, Struct& value) const {
    fields_of(FieldReader(in, version_, names_), value);
  }

  static bool is_estimator(const std::string& name) {
    const auto all = all_estimators();
    return std::find(all.begin(), all.end(), name) != all.end();
  }

  const json& object_;
  int version_;
  std::vector<std::string> names_;
};

std::vector<std::string> names_of_today(std::vector<std::string> names) {
  for (std::string& name : names)
    for (const auto& [before, now] : names_before_version_2)
      if (name == before) name = now;
  return names;
}

std::string text_of(const json& object) {
  return object.dump(-1, ' ', false, json::error_handler_t::replace);
}

/// One text to JSON: not too long, not nested deeper than a result is.
json parsed(const std::string& text) {
  if (text.size() > max_text) throw std::out_of_range("it is far too long");
  const auto is_shallow = [](int depth, json::parse_event_t, json&) { return depth <= max_depth; };
  json object = json::parse(text, is_shallow, false);
  if (object.is_discarded() || !object.is_object()) throw std::out_of_range("it is not a JSON object");
  return object;
}

int version_of(const json& object) {
  if (object.value("format", json()) != format_name) throw std::out_of_range("format: is another");
  const json version = object.value("version", json());
  if (!version.is_number_integer() || version < 1 || version > format_version)
    throw std::out_of_range("version: is not known here");
  return version.get<int>();
}

/// SHA-256 of all other fields, as they are written.
void require_sum(json object) {
  const json sum = object.value("sum", json());
  object.erase("sum");
  if (fingerprint_of(text_of(object)) != sum) throw std::out_of_range("sum: is that of other values");
}

/// What tables and charts reckon with.
void require_ranges(const JobResult& result) {
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw std::out_of_range(what);
  };
  const Job& job = result.job;
  require(job.frames >= network::min_frames && job.frames <= network::max_frames, "job.frames cannot be");
  require(job.reduction >= network::min_reduction && job.reduction <= network::max_reduction,
          "job.reduction cannot be");
  require(job.epochs >= 1, "job.epochs cannot be");
  require(job.history >= 0, "job.history cannot be");
  require(result.label_scale_dps > 0.0, "label_scale_dps cannot be");
  require(result.evaluation.names.size() == result.evaluation.angles.size(), "names has another length");
  for (const std::uint64_t count : result.evaluation.gain.histogram)
    require(count <= max_count, "gain.histogram cannot be");
  for (const AngleTrack& track : result.evaluation.angles) {
    require(track.commanded_deg.size() == track.time_s.size(), "commanded_deg has another length");
    for (const std::vector<double>& line : track.error_deg.values())
      require(line.empty() || line.size() == track.time_s.size(), "error_deg has another length");
  }
}

}  // namespace

std::string to_json(const JobResult& result) {
  json object{{"format", format_name}, {"version", format_version}, {"estimators", all_estimators()}};
  fields_of(FieldWriter(object, OverEstimators::as_list), result);
  object = json::parse(text_of(object));  // as a reader will have it
  object["sum"] = fingerprint_of(text_of(object));
  return text_of(object) + "\n";
}

JobResult result_from_json(const std::string& text, const std::string& where) {
  try {
    const json object = parsed(text);
    const int version = version_of(object);
    if (version >= with_sum) require_sum(object);
    std::vector<std::string> names;
    FieldReader(object, version, {})("estimators", names);
    JobResult result;
    fields_of(FieldReader(object, version, names_of_today(std::move(names))), result);
    result.evaluation.simulated = result.simulated;
    require_ranges(result);
    return result;
  } catch (const std::exception& error) {  // of the JSON library too
    throw Error(ExitCode::not_a_session, fmt::format("this is no sound result of a study: {}", error.what()),
                where, "delete it and run the study again: only this job is then repeated");
  }
}

}  // namespace thermorig::study
