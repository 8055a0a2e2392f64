// SPDX-License-Identifier: MIT
#include "thermorig/recording_header/header_json.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "header_check.h"
#include "thermorig/core/code_point.h"
#include "thermorig/core/error.h"

namespace thermorig {
namespace {

/// The library casts whatever number stands there. Throws std::out_of_range.
template <typename Integer>
Integer whole_number(const nlohmann::json& in) {
  const bool fits = in.is_number_unsigned()
                        ? std::in_range<Integer>(in.get<std::uint64_t>())
                        : in.is_number_integer() && std::in_range<Integer>(in.get<std::int64_t>());
  if (!fits)
    throw std::out_of_range((in.is_number() ? in.dump() : in.type_name()) +
                            " is no whole number, or too large");
  return in.get<Integer>();
}

}  // namespace
}  // namespace thermorig

// Keys are the members' names: one list serves both directions. Keys that came after format 1.0.0 may be
// absent: their members keep the defaults.
namespace nlohmann {

template <>
struct adl_serializer<thermorig::HostTime> {
  static void to_json(json& out, const thermorig::HostTime& time) { out = thermorig::to_ns(time); }
  static void from_json(const json& in, thermorig::HostTime& time) {
    time = thermorig::host_time_ns(thermorig::whole_number<std::int64_t>(in));
  }
};

template <>
struct adl_serializer<std::optional<std::uint64_t>> {
  static void to_json(json& out, const std::optional<std::uint64_t>& value) {
    out = value ? json(*value) : json(nullptr);
  }
  static void from_json(const json& in, std::optional<std::uint64_t>& value) {
    value = in.is_null() ? std::nullopt : std::optional(thermorig::whole_number<std::uint64_t>(in));
  }
};

}  // namespace nlohmann

namespace thermorig {

NLOHMANN_JSON_SERIALIZE_ENUM(ChecksumPolicy, {{ChecksumPolicy::word, "word"},
                                              {ChecksumPolicy::byte, "byte"},
                                              {ChecksumPolicy::ignore, "ignore"}})
NLOHMANN_JSON_SERIALIZE_ENUM(ServoKind,
                             {{ServoKind::positional, "positional"}, {ServoKind::continuous, "continuous"}})

namespace {

using nlohmann::json;

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

template <typename Value, std::size_t size>
void read(const json& in, std::array<Value, size>& values) {
  for (std::size_t i = 0; i < size; ++i) read(in.at(i), values[i]);
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

template <typename Keys, typename Columns>
void text_keys(const Keys& keys, Columns& columns) {
  keys.required("prefix", columns.prefix);
  keys.required("rate", columns.rate);
  keys.required("scale_dps", columns.scale_dps);
  keys.required("time", columns.time);
  keys.required("time_unit_s", columns.time_unit_s);
}

template <typename Keys, typename Link>
void port_keys(const Keys& keys, Link& link) {
  keys.required("port", link.port);
  keys.required("usb_path", link.usb_path);
  keys.required("baud", link.baud);
  keys.required("latency_s", link.latency_s);
  keys.later("latency_uncertainty_s", link.latency_uncertainty_s);
  keys.later("latency_measured_utc", link.latency_measured_utc);
  keys.later("largest_constant_delay_s", link.largest_constant_delay_s);
  keys.later("wander_ppm", link.wander_ppm);
  keys.required("reset_on_open", link.reset_on_open);
}

template <typename Keys, typename Camera>
void camera_keys(const Keys& keys, Camera& camera) {
  keys.required("link", camera.link);
  keys.required("model", camera.model);
  keys.later("protocol", camera.protocol);
  keys.required("output_rate_hz", camera.output_rate_hz);
  keys.required("field_of_view_deg", camera.field_of_view_deg);
  keys.required("mirrored", camera.mirrored);
  keys.later("orientation_measured_utc", camera.orientation_measured_utc);
  keys.required("checksum", camera.checksum);
}

template <typename Keys, typename Gyro>
void gyro_keys(const Keys& keys, Gyro& gyro) {
  keys.required("link", gyro.link);
  keys.required("model", gyro.model);
  keys.required("protocol", gyro.protocol);
  keys.required("text", gyro.text);
  keys.required("output_rate_hz", gyro.output_rate_hz);
  keys.required("axis", gyro.axis);
  keys.required("sign", gyro.sign);
  keys.later("scale", gyro.scale);
  keys.later("scale_uncertainty", gyro.scale_uncertainty);
  keys.later("scale_measured_utc", gyro.scale_measured_utc);
  keys.later("bias_dps", gyro.bias_dps);
  keys.later("bias_uncertainty_dps", gyro.bias_uncertainty_dps);
  keys.later("bias_measured_utc", gyro.bias_measured_utc);
}

template <typename Keys, typename Servo>
void servo_keys(const Keys& keys, Servo& servo) {
  keys.required("link", servo.link);
  keys.required("model", servo.model);
  keys.required("kind", servo.kind);
  keys.required("travel_deg", servo.travel_deg);
  keys.required("full_rate_dps", servo.full_rate_dps);
  keys.required("pulse_min_us", servo.pulse_min_us);
  keys.required("pulse_max_us", servo.pulse_max_us);
  keys.required("max_rate_dps", servo.max_rate_dps);
  keys.required("acceleration_dps2", servo.acceleration_dps2);
  keys.required("stop_margin_deg", servo.stop_margin_deg);
  keys.required("settle_s", servo.settle_s);
  keys.later("loop_hz", servo.loop_hz);
  keys.later("scale", servo.scale);
  keys.later("scale_uncertainty", servo.scale_uncertainty);
  keys.later("scale_measured_utc", servo.scale_measured_utc);
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
}

}  // namespace

void to_json(nlohmann::json& out, const TextColumns& columns) {
  text_keys(Writer{out}, columns);
}
void from_json(const nlohmann::json& in, TextColumns& columns) {
  text_keys(Reader{in}, columns);
}
void to_json(nlohmann::json& out, const PortProfile& link) {
  port_keys(Writer{out}, link);
}
void from_json(const nlohmann::json& in, PortProfile& link) {
  port_keys(Reader{in}, link);
}
void to_json(nlohmann::json& out, const CameraProfile& camera) {
  camera_keys(Writer{out}, camera);
}
void from_json(const nlohmann::json& in, CameraProfile& camera) {
  camera_keys(Reader{in}, camera);
}
void to_json(nlohmann::json& out, const GyroProfile& gyro) {
  gyro_keys(Writer{out}, gyro);
  if (!gyro.settings.empty()) out["settings"] = gyro.settings;
}
void from_json(const nlohmann::json& in, GyroProfile& gyro) {
  gyro_keys(Reader{in}, gyro);
  Reader{in}.later("settings", gyro.settings);
}
void to_json(nlohmann::json& out, const ServoProfile& servo) {
  servo_keys(Writer{out}, servo);
}
void from_json(const nlohmann::json& in, ServoProfile& servo) {
  servo_keys(Reader{in}, servo);
}
void to_json(nlohmann::json& out, const LiveModel& model) {
  live_model_keys(Writer{out}, model);
}
void from_json(const nlohmann::json& in, LiveModel& model) {
  live_model_keys(Reader{in}, model);
}

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(RigProfile, name, camera, gyro, servo)

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
  keys.required("profile", header.profile);
  keys.required("profile_toml", header.profile_toml);
  keys.required("plan_name", header.plan_name);
  keys.required("plan_toml", header.plan_toml);
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
  if (!header.live_model.name.empty()) out["live_model"] = header.live_model;
}
void from_json(const nlohmann::json& in, RecordingHeader& header) {
  const Reader keys{in};
  header_keys(keys, header);
  keys.later("licence", header.licence);
  keys.later("live_model", header.live_model);
}

namespace recording_header {

namespace {

constexpr std::size_t longest_licence = 1000;  // bytes
constexpr int depth_max = 16;                  // a header has five levels

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

bool is_licence(std::string_view text) {
  const auto is_control = [](char c) { return (c >= 0 && c < ' ') || c == 127; };
  return !text.empty() && text.size() <= longest_licence &&
         std::none_of(text.begin(), text.end(), is_control) && is_utf8(text);
}

std::string header_to_json_text(const RecordingHeader& header) {
  if (const auto problem = problem_of(header))
    throw Error(ExitCode::bad_usage, *problem, "recording header", "correct the profile or the command line");
  return nlohmann::json(header).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

RecordingHeader header_from_json_text(std::string_view text, const std::string& where) {
  const std::string advice = "the file is damaged or was not written by thermorig";
  const auto unreadable = [&](const std::exception& error) {
    return Error(ExitCode::not_a_session, "its header cannot be read: " + without_library_name(error.what()),
                 where, advice);
  };
  try {
    auto header = json::parse(text, is_shallow).get<RecordingHeader>();
    if (const auto problem = problem_of(header))
      throw Error(ExitCode::not_a_session, *problem, where, advice);
    return header;
  } catch (const nlohmann::json::exception& error) {
    throw unreadable(error);
  } catch (const std::out_of_range& error) {
    throw unreadable(error);
  }
}

}  // namespace recording_header
}  // namespace thermorig
