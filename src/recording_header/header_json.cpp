// SPDX-License-Identifier: MIT
#include "thermorig/recording_header/header_json.h"

#include <nlohmann/json.hpp>

#include "header_check.h"
#include "thermorig/core/error.h"

// Keys are the members' names: one list serves both directions.
namespace nlohmann {

template <>
struct adl_serializer<thermorig::HostTime> {
  static void to_json(json& out, const thermorig::HostTime& time) { out = thermorig::to_ns(time); }
  static void from_json(const json& in, thermorig::HostTime& time) {
    time = thermorig::host_time_ns(in.get<std::int64_t>());
  }
};

template <>
struct adl_serializer<std::optional<std::uint64_t>> {
  static void to_json(json& out, const std::optional<std::uint64_t>& value) {
    out = value ? json(*value) : json(nullptr);
  }
  static void from_json(const json& in, std::optional<std::uint64_t>& value) {
    value = in.is_null() ? std::nullopt : std::optional(in.get<std::uint64_t>());
  }
};

}  // namespace nlohmann

namespace thermorig {

NLOHMANN_JSON_SERIALIZE_ENUM(ChecksumPolicy, {{ChecksumPolicy::word, "word"},
                                              {ChecksumPolicy::byte, "byte"},
                                              {ChecksumPolicy::ignore, "ignore"}})
NLOHMANN_JSON_SERIALIZE_ENUM(GyroProtocol,
                             {{GyroProtocol::witmotion, "witmotion"}, {GyroProtocol::text, "text"}})
NLOHMANN_JSON_SERIALIZE_ENUM(ServoKind,
                             {{ServoKind::positional, "positional"}, {ServoKind::continuous, "continuous"}})
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PortProfile, port, usb_path, baud, latency_s, reset_on_open)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(CameraProfile, link, model, output_rate_hz, field_of_view_deg, mirrored,
                                   checksum)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TextColumns, prefix, rate, scale_dps, time, time_unit_s)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(GyroProfile, link, model, protocol, text, output_rate_hz, axis, sign)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ServoProfile, link, model, kind, travel_deg, full_rate_dps, pulse_min_us,
                                   pulse_max_us, max_rate_dps, acceleration_dps2, stop_margin_deg, settle_s)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(RigProfile, name, camera, gyro, servo)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(RecordingHeader, uuid, environment, acquisition, title, start_time_utc,
                                   time_reference, realtime_offset_ns, simulated, simulation_seed, simulation,
                                   profile, profile_toml, plan_name, plan_toml, frames_per_leg, creator,
                                   creator_git, host_name, kernel, firmware)

namespace recording_header {

std::string header_to_json_text(const RecordingHeader& header) {
  if (const auto problem = problem_of(header))
    throw Error(ExitCode::bad_usage, *problem, "recording header", "correct the profile or the command line");
  return nlohmann::json(header).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

RecordingHeader header_from_json_text(std::string_view text, const std::string& where) {
  const std::string advice = "the file is damaged or was not written by thermorig";
  try {
    auto header = nlohmann::json::parse(text).get<RecordingHeader>();
    if (const auto problem = problem_of(header))
      throw Error(ExitCode::not_a_session, *problem, where, advice);
    return header;
  } catch (const nlohmann::json::exception& error) {
    throw Error(ExitCode::not_a_session, std::string("its header cannot be read: ") + error.what(), where,
                advice);
  }
}

}  // namespace recording_header
}  // namespace thermorig
