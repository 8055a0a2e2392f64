// SPDX-License-Identifier: MIT
#include "group_attributes.h"

#include <fmt/format.h>

#include <limits>

#include "attributes.h"
#include "format.h"
#include "group_writer.h"
#include "scalars.h"
#include "sync_attributes.h"
#include "thermorig/core/validity.h"
#include "thermorig/sensors/wire/counter_names.h"
#include "thermorig/storage/session/annotations.h"

namespace thermorig::session {

namespace {

std::uint8_t flag(bool value) {
  return value ? 1 : 0;
}

/// Writes what sync_attributes.h lists.
struct AttributeWriter {
  hid_t group;
  void operator()(const char* name, const std::string& value) { set_attribute(group, name, value); }
  void operator()(const char* name, double value) { set_attribute(group, name, value); }
  void operator()(const char* name, std::uint32_t value) { set_attribute(group, name, value); }
  void operator()(const char* name, bool value) { set_attribute(group, name, flag(value)); }
  void operator()(const char* name, const std::optional<double>& value) {
    set_attribute(group, name, value.value_or(std::numeric_limits<double>::quiet_NaN()));
  }
};

/// How hard the scene is for the camera: the order of contrast in the environments of the published rig.
const char* difficulty_of(const std::string& environment) {
  if (environment == "laboratory") return "low";
  if (environment == "dining" || environment == "kitchen") return "medium";
  if (environment == "garden") return "high";
  return "unknown";
}

std::string hdf5_version() {
  unsigned major = 0, minor = 0, release = 0;
  check(H5get_libversion(&major, &minor, &release), "tell the version of HDF5");
  return fmt::format("{}.{}.{}", major, minor, release);
}

void write_simulation(hid_t root, const RecordingHeader& header) {
  set_attribute(root, "simulated", flag(header.simulated));
  if (header.simulation_seed) set_attribute(root, "simulation_seed", *header.simulation_seed);
  if (header.simulated) set_attribute(root, "simulation", header.simulation);
}

void write_stream(hid_t group, const std::string& name, const Quality::Stream& stream) {
  const auto set = [&](const char* what, auto value) { set_attribute(group, (name + what).c_str(), value); };
  set("_received", stream.received);
  set("_lost", stream.lost);
  set("_bad", stream.bad);
  set("_repeated", stream.repeated);
  set("_rate_min_hz", stream.rate_min_hz);
  set("_rate_mean_hz", stream.rate_mean_hz);
  set("_rate_max_hz", stream.rate_max_hz);
  set("_gap_max_s", stream.gap_max_s);
}

void write_sync_quality(hid_t group, const Quality& quality) {
  for (const Device device : all_devices) {
    const std::string name(thermorig::name_of(device));
    set_attribute(group, (name + "_clock_uncertainty_s").c_str(), quality.clock[device].uncertainty_s);
    set_attribute(group, (name + "_clock_bound_s").c_str(), quality.clock[device].bound_s);
  }
  const Estimate unknown{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
  const Estimate offset = quality.camera_offset_s.value_or(unknown);
  set_attribute(group, "camera_offset_s", offset.value);
  set_attribute(group, "camera_offset_uncertainty_s", offset.uncertainty);
  set_attribute(group, "rate_shaft_uncertainty_dps", quality.rate_shaft_uncertainty_dps);
  set_attribute(group, "gyro_residual_dps", quality.gyro_residual_dps);
}

}  // namespace

void write_root_attributes(hid_t root, const Session& session) {
  const auto& header = session.raw.header;
  const double duration_s = to_s(session.raw.end_time - header.time_reference);
  set_attribute(root, "NX_class", "NXroot");
  set_attribute(root, "default", "samples");
  set_attribute(root, "format", format_name);
  set_attribute(root, "format_version", format_version.text() + ".0");
  set_attribute(root, "uuid", header.uuid);
  set_attribute(root, "title", header.title);
  set_attribute(root, "start_time", header.start_time_utc);
  set_attribute(root, "end_time", utc_after(header.start_time_utc, duration_s));
  set_attribute(root, "time_reference", header.start_time_utc);
  set_attribute(root, "time_reference_ns", to_ns(header.time_reference));
  set_attribute(root, "end_time_ns", to_ns(session.raw.end_time));
  set_attribute(root, "timezone", "UTC");
  set_attribute(root, "duration_s", duration_s);
  set_attribute(root, "state", name_of(session.state));
  set_attribute(root, "closed_by_recorder", flag(session.raw.complete));
  write_simulation(root, header);
  set_attribute(root, "creator", header.creator);
  set_attribute(root, "creator_git", header.creator_git);
  set_attribute(root, "host_name", header.host_name);
  set_attribute(root, "kernel", header.kernel);
  set_attribute(root, "HDF5_Version", hdf5_version());
  set_attribute(root, "Conventions", "CF-1.10");
  if (!header.operator_name.empty()) set_attribute(root, "operator", header.operator_name);
  if (!header.note.empty()) set_attribute(root, "note", header.note);
  set_attribute(root, "license", header.licence.empty() ? licence_not_stated : header.licence);
  set_attribute(root, "scalars_crc32", scalars_crc32(session, header_text(header), format_version));
}

void write_camera_attributes(hid_t group, const Session& session) {
  set_attribute(group, "mode", session.camera_mode);
  set_attribute(group, "frame_period_s", session.frame_period_s);
}

void write_sync_attributes(hid_t group, const Session& session) {
  set_attribute(group, "method", "one-way and two-way bounds of each device's clock, minus its latency");
  set_attribute(group, "host_clock", "CLOCK_MONOTONIC");
  set_attribute(group, "realtime_offset_ns", session.raw.header.realtime_offset_ns);
  AttributeWriter writer{group};
  sync_attributes(writer, session.sync, format_version);
}

void write_clock_attributes(hid_t group, const ClockReport& clock) {
  AttributeWriter writer{group};
  clock_attributes(writer, clock, format_version);
}

void write_samples_attributes(hid_t group, const Session& session) {
  plot_as(group, "rate_shaft", {"time"}, {"rate_gyro"});
  set_attribute(group, "label_version", "3");
  const bool has_servo = session.raw.header.profile.servo.is_there();
  set_attribute(group, "label_source", has_servo ? "command" : "gyro");
  set_attribute(
      group, "label_rule",
      !has_servo ? "rate_shaft: mean rate of the gyro over the exposure of both halves of the "
                   "frame, less its bias, over its scale; nothing was commanded"
                 : "rate_commanded: mean speed of the servo's pulses over the exposure of both halves of the "
                   "frame; rate_corrected: the same, corrected by what the session measured of the servo; "
                   "rate_shaft: mean speed of the shaft by the servo model over the same exposure");
  set_attribute(group, "settle_s", session.settle_s);
}

void write_estimates_attributes(hid_t group, const Session& session) {
  const LiveModel& model = session.raw.header.live_model;
  plot_as(group, "rate", {"time", "estimator"}, {"rate_commanded"});
  set_attribute(group, "model", model.name);
  set_attribute(group, "model_hash", model.hash);
  set_attribute(group, "model_frames", model.frames);
  set_attribute(group, "model_reduction", model.reduction);
  set_attribute(group, "model_fusion", flag(model.fusion));
  set_attribute(group, "model_simulated", flag(model.simulated));
  set_attribute(group, "label_scale_dps", model.label_scale_dps);
  set_attribute(group, "model_precision", model.precision);
}

void write_environment_attributes(hid_t group, const Session& session) {
  const auto& header = session.raw.header;
  set_attribute(group, "NX_class", "NXenvironment");
  const Place place = place_of(session);
  set_attribute(group, "name", place.environment);
  set_attribute(group, "difficulty", difficulty_of(place.environment));
  set_attribute(group, "acquisition_number", place.acquisition);
  if (!header.place.empty()) set_attribute(group, "place", header.place);
}

void write_rig_attributes(hid_t group, const Session& session) {
  const auto& header = session.raw.header;
  set_attribute(group, "plan_name", header.plan_name);
  set_attribute(group, "frames_per_leg", header.frames_per_leg);
  set_attribute(group, "firmware", header.firmware);
}

void write_raw_attributes(hid_t group, const wire::Counters& counters) {
  for (const auto& counter : wire::counter_names)
    set_attribute(group, counter.name, counters.*counter.member);
}

void write_quality_attributes(hid_t group, const Quality& quality) {
  for (const Device device : all_devices)
    write_stream(group, std::string(thermorig::name_of(device)), quality.stream[device]);
  set_attribute(group, "duration_s", quality.duration_s);
  set_attribute(group, "frames", quality.frames);
  set_attribute(group, "frames_swept", quality.swept);
  set_attribute(group, "frames_valid", quality.valid);
  for (const auto& [reason, count] : quality.reason_counts)
    set_attribute(group, ("reason_" + reason).c_str(), count);
  write_sync_quality(group, quality);
  set_attribute(group, "verdict", quality.verdict);
  set_attribute(group, "verdict_reasons", quality.verdict_reasons);
  set_attribute(group, "check_version", "2");
}

}  // namespace thermorig::session
