// SPDX-License-Identifier: MIT
#include "thermorig/storage/recording_header/header_json.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <type_traits>

#include "header_check.h"
#include "profile_json.h"
#include "thermorig/core/code_point.h"
#include "thermorig/core/error.h"

// Keys are the members' names: one list serves both directions. Keys that came after format 1.0.0 may be
// absent: their members keep the defaults.
namespace nlohmann {

template <>
struct adl_serializer<thermorig::HostTime> {
  static void to_json(json& out, const thermorig::HostTime& time) { out = thermorig::to_ns(time); }
  static void from_json(const json& in, thermorig::HostTime& time) {
    time = thermorig::host_time_ns(thermorig::recording_header::whole_number<std::int64_t>(in));
  }
};

template <>
struct adl_serializer<std::optional<std::uint64_t>> {
  static void to_json(json& out, const std::optional<std::uint64_t>& value) {
    out = value ? json(*value) : json(nullptr);
  }
  static void from_json(const json& in, std::optional<std::uint64_t>& value) {
    value = in.is_null() ? std::nullopt
                         : std::optional(thermorig::recording_header::whole_number<std::uint64_t>(in));
  }
};

}  // namespace nlohmann

namespace thermorig {

namespace {

using nlohmann::json;
using recording_header::whole_number;

struct Writer {
  json& out;
  template <typename Value>
  void required(const char* key, const Value& value) const {
    out[key] = value;
  }
  template <typename Value>
  void later(const char* key, const Value& value) const {
    out[key] = value;
  }
};

template <typename Value>
void read(const json& in, Value& value) {
  if constexpr (std::is_integral_v<Value> && !std::is_same_v<Value, bool>)
    value = whole_number<Value>(in);
  else
    in.get_to(value);
}

struct Reader {
  const json& in;
  template <typename Value>
  void required(const char* key, Value& value) const {
    read(in.at(key), value);
  }
  template <typename Value>
  void later(const char* key, Value& value) const {
    if (const auto found = in.find(key); found != in.end()) read(*found, value);
  }
};

template <typename Keys, typename Column>
void estimator_keys(const Keys& keys, Column& column) {
  keys.required("name", column.name);
  keys.required("values", column.values);
}

template <typename Keys, typename Model>
void live_model_keys(const Keys& keys, Model& model) {
  keys.required("name", model.name);
  keys.required("hash", model.hash);
  keys.required("frames", model.frames);
  keys.required("reduction", model.reduction);
  keys.required("fusion", model.fusion);
  keys.required("simulated", model.simulated);
  keys.required("label_scale_dps", model.label_scale_dps);
  keys.later("precision", model.precision);
  keys.later("turned", model.turned);
}

}  // namespace

void to_json(nlohmann::json& out, const EstimatorColumn& column) {
  estimator_keys(Writer{out}, column);
}
void from_json(const nlohmann::json& in, EstimatorColumn& column) {
  estimator_keys(Reader{in}, column);
}
void to_json(nlohmann::json& out, const LiveModel& model) {
  live_model_keys(Writer{out}, model);
}
void from_json(const nlohmann::json& in, LiveModel& model) {
  live_model_keys(Reader{in}, model);
}

namespace {

template <typename Keys, typename Header>
void header_keys(const Keys& keys, Header& header) {
  keys.required("uuid", header.uuid);
  keys.required("environment", header.environment);
  keys.required("acquisition", header.acquisition);
  keys.required("title", header.title);
  keys.required("start_time_utc", header.start_time_utc);
  keys.required("time_reference", header.time_reference);
  keys.required("realtime_offset_ns", header.realtime_offset_ns);
  keys.required("simulated", header.simulated);
  keys.required("simulation_seed", header.simulation_seed);
  keys.required("simulation", header.simulation);
  keys.required("plan_name", header.plan_name);
  keys.required("frames_per_leg", header.frames_per_leg);
  keys.required("creator", header.creator);
  keys.required("creator_git", header.creator_git);
  keys.required("host_name", header.host_name);
  keys.required("kernel", header.kernel);
  keys.required("firmware", header.firmware);
}

}  // namespace

void to_json(nlohmann::json& out, const RecordingHeader& header) {
  header_keys(Writer{out}, header);
  if (!header.licence.empty()) out["licence"] = header.licence;
  if (!header.operator_name.empty()) out["operator"] = header.operator_name;
  if (!header.place.empty()) out["place"] = header.place;
  if (!header.note.empty()) out["note"] = header.note;
  if (!header.shaft_sensor.empty()) out["shaft_sensor"] = header.shaft_sensor;
  if (!header.live_model.name.empty()) out["live_model"] = header.live_model;
  if (!header.estimators.empty()) out["estimators"] = header.estimators;
}
void from_json(const nlohmann::json& in, RecordingHeader& header) {
  const Reader keys{in};
  header_keys(keys, header);
  keys.later("licence", header.licence);
  keys.later("operator", header.operator_name);
  keys.later("place", header.place);
  keys.later("note", header.note);
  keys.later("shaft_sensor", header.shaft_sensor);
  keys.later("live_model", header.live_model);
  keys.later("estimators", header.estimators);
}

namespace recording_header {

namespace {

constexpr std::size_t longest_line = 1000;  // bytes
constexpr int depth_max = 16;               // a header has five levels

/// What lies deeper is dropped while it is read: the library's other functions go down by recursion.
bool is_shallow(int depth, json::parse_event_t, json&) {
  return depth <= depth_max;
}

/// Only such text is read back as it was: other bytes are repaired, and grow.
/// The library begins its messages with "[json.exception.type_error.302] ".
std::string without_library_name(std::string_view message) {
  if (message.starts_with('[')) message.remove_prefix(std::min(message.find(']') + 1, message.size()));
  message.remove_prefix(std::min(message.find_first_not_of(' '), message.size()));
  return std::string(message);
}

}  // namespace

bool is_line(std::string_view text) {
  const auto is_control = [](char c) { return (c >= 0 && c < ' ') || c == 127; };
  return !text.empty() && text.size() <= longest_line && std::none_of(text.begin(), text.end(), is_control) &&
         is_utf8(text);
}

std::string header_to_json_text(const RecordingHeader& header, ProfileAndPlan place) {
  if (const auto problem = problem_of(header))
    throw Error(ExitCode::bad_usage, *problem, "recording header", "correct the profile or the command line");
  json object(header);
  if (place == ProfileAndPlan::in_header) {
    object["profile"] = profile_to_json(header.profile);
    object["plan_toml"] = header.plan_toml;
  }
  return object.dump(-1, ' ', false, json::error_handler_t::replace);
}

RecordingHeader header_from_json_text(std::string_view text, const std::string& where, ProfileAndPlan place) {
  const std::string advice = "the file is damaged or was not written by thermorig";
  const auto unreadable = [&](const std::exception& error) {
    return Error(ExitCode::not_a_session, "its header cannot be read: " + without_library_name(error.what()),
                 where, advice);
  };
  try {
    const json object = json::parse(text, is_shallow);
    auto header = object.get<RecordingHeader>();
    if (place == ProfileAndPlan::in_header) {
      header.profile = profile_from_json(object.at("profile"));
      object.at("plan_toml").get_to(header.plan_toml);
    }
    if (const auto problem = problem_of(header))
      throw Error(ExitCode::not_a_session, *problem, where, advice);
    return header;
  } catch (const json::exception& error) {
    throw unreadable(error);
  } catch (const std::out_of_range& error) {
    throw unreadable(error);
  }
}

}  // namespace recording_header
}  // namespace thermorig
