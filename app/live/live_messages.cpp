// SPDX-License-Identifier: MIT
#include "live_messages.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <random>

#include "build_information.h"
#include "print/number_json.h"
#include "print/scores_json.h"
#include "thermorig/core/base64.h"
#include "thermorig/core/image_bytes.h"
#include "thermorig/estimators/table.h"

namespace thermorig::app {

namespace {

double seconds(HostTime time, HostTime begin) {
  return to_s(time - begin);
}

/// Tells this run from every other, a second replay of the same session too: 16 hexadecimal digits.
const std::string& run_id() {
  static const std::string id = [] {
    std::random_device device;
    return fmt::format("{:08x}{:08x}", device() & 0xFFFFFFFFU, device() & 0xFFFFFFFFU);
  }();
  return id;
}

nlohmann::json model_json(const LiveModel& model) {
  if (model.name.empty()) return {};
  return {{"name", model.name},     {"frames", model.frames},       {"reduction", model.reduction},
          {"fusion", model.fusion}, {"precision", model.precision}, {"simulated", model.simulated},
          {"turned", model.turned}};
}

nlohmann::json estimators_json(const std::vector<EstimatorColumn>& estimators) {
  nlohmann::json list = nlohmann::json::array();
  for (const EstimatorColumn& column : estimators)
    list.push_back(
        {{"name", column.name}, {"title", estimators::entry(column.name).title}, {"values", column.values}});
  return list;
}

nlohmann::json estimator_json(const RateEstimate& estimate, const EstimatorColumn& column) {
  nlohmann::json values = nlohmann::json::object();
  for (std::size_t i = 0; i < column.values.size(); ++i)
    values[column.values[i]] = number_json(estimate.values[i]);
  const bool has_reason = estimate.reason != EstimateReason::none;
  return {{"rate_dps", number_json(estimate.rate_dps)},
          {"rate_sigma_dps", number_json(estimate.rate_sigma_dps)},
          {"angle_deg", number_json(estimate.angle_deg)},
          {"angle_sigma_deg", number_json(estimate.angle_sigma_deg)},
          {"state", thermorig::name_of(estimate.state)},
          {"reason", has_reason ? nlohmann::json(thermorig::name_of(estimate.reason)) : nlohmann::json()},
          {"values", std::move(values)}};
}

nlohmann::json estimates_json(const LiveFrame& frame) {
  nlohmann::json estimates = nlohmann::json::object();
  for (std::size_t i = 0; i < frame.estimators.size(); ++i)
    estimates[frame.estimators[i].name] = estimator_json(frame.row.estimates[i], frame.estimators[i]);
  return estimates;
}

// A camera's reads are coarse: a bridge that is read once in half a second is still alive.
std::string state_of(Device device, const rig::RecordingProgress& progress) {
  const rig::DeviceHealth& health = progress.health[device];
  if (progress.gone[device]) return progress.absent[device] ? "absent" : "lost";
  if (progress.awaited[device]) return "awaited";
  if (!health.age_s) return "waiting";
  constexpr double late_periods = 3.0;
  constexpr double camera_late_s = 0.5,
                   others_late_s = 0.1;  // USB hands bytes over in blocks of 16 ms or more
  const double periods_s = late_periods / health.expected_hz;
  const double least_s = device == Device::camera ? camera_late_s : others_late_s;
  return *health.age_s > std::max(least_s, periods_s) ? "late" : "ok";
}

nlohmann::json device_json(Device device, const rig::RecordingProgress& progress) {
  const rig::DeviceHealth& health = progress.health[device];
  const std::optional<rig::AwaitedDevice>& awaited = progress.awaited[device];
  return {{"state", state_of(device, progress)},
          {"left_s", awaited ? number_json(awaited->left_s) : nlohmann::json()},
          {"expected_hz", number_json(health.expected_hz)},
          {"rate_min_hz", number_json(health.rate_min_hz)},
          {"rate_max_hz", number_json(health.rate_max_hz)},
          {"age_s", number_json(health.age_s)},
          {"messages", health.messages},
          {"lost", health.lost},
          {"bad", health.bad},
          {"skipped_bytes", health.skipped_bytes},
          {"uncertainty_s", number_json(health.uncertainty_s)}};
}

nlohmann::json quotas_json(const std::vector<rig::SpeedQuota>& speeds) {
  nlohmann::json list = nlohmann::json::array();
  for (const rig::SpeedQuota& speed : speeds)
    list.push_back({{"rate_dps", speed.rate_dps}, {"valid", speed.valid}, {"quota", speed.wanted}});
  return list;
}

}  // namespace

std::string name_of(LiveMode mode) {
  if (mode == LiveMode::live) return "live";
  return mode == LiveMode::record ? "record" : "replay";
}

std::string freshness(const TimedFrame& frame) {
  if (frame.fresh_even > 0 && frame.fresh_odd > 0) return "both";
  return frame.fresh_even > 0 || frame.fresh_odd > 0 ? "half" : "repeated";
}

std::string why_excluded(const LiveFrame& frame) {
  if (frame.row.counted) return "";
  if (frame.row.reason_bits != 0)
    return fmt::format("{}", fmt::join(reason_texts(frame.row.reason_bits), ", "));
  return frame.sample.valid ? "window begins in another run" : "not valid";
}

std::vector<std::string> reason_texts(std::uint32_t bits) {
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < reason_count; ++i)
    if ((bits >> i & 1U) != 0) texts.emplace_back(reason_names[i]);
  return texts;
}

nlohmann::json hello_message(const LiveFacts& facts) {
  const RecordingHeader& header = facts.header;
  return {{"event", "hello"},
          {"version", build_information::version},
          {"run", run_id()},
          {"mode", name_of(facts.mode)},
          {"recording", facts.recording},
          {"simulated", header.simulated},
          {"simulation", header.simulation},
          {"environment", header.environment},
          {"acquisition", header.acquisition > 0 ? nlohmann::json(header.acquisition) : nlohmann::json()},
          {"start_utc", header.start_time_utc},
          {"control", facts.control},
          {"frame_rate_hz", number_json(header.profile.camera.output_rate_hz)},
          {"model", model_json(header.live_model)},
          {"estimators", estimators_json(header.estimators)},
          {"plan",
           {{"name", facts.plan_name},
            {"repeats", facts.repeats},
            {"legs", facts.legs},
            {"frames_per_leg", facts.frames_per_leg},
            {"expected_s", number_json(facts.expected_s)}}}};
}

nlohmann::json state_message(const rig::RecordingProgress& progress, const LiveFacts& facts,
                             std::optional<std::uint64_t> disk_free_bytes) {
  const rig::SweepProgress& sweep = progress.sweep;
  const bool keeps = facts.recording;
  nlohmann::json devices;
  for (const Device device : all_devices)
    devices[std::string(thermorig::name_of(device))] = device_json(device, progress);
  return {
      {"event", "state"},
      {"time_s", number_json(progress.elapsed_s)},
      {"phase", rig::name_of(sweep.phase)},
      {"eta_s", facts.repeats ? nlohmann::json() : number_json(sweep.eta_s)},
      {"done_share", number_json(sweep.done_share)},
      {"leg", sweep.leg},
      {"leg_count", sweep.leg_count},
      {"rate_dps", number_json(sweep.rate_dps)},
      {"next_rate_dps", number_json(sweep.next_rate_dps)},
      {"frames", sweep.frames},
      {"frames_per_leg", sweep.frames_per_leg},
      {"repeated", sweep.repeated},
      {"speeds", quotas_json(sweep.speeds)},
      {"devices", devices},
      {"kept_frames", keeps ? nlohmann::json(progress.health[Device::camera].messages) : nlohmann::json()},
      {"kept_bytes", keeps ? nlohmann::json(progress.kept_bytes) : nlohmann::json()},
      {"disk_free_bytes", keeps && disk_free_bytes ? nlohmann::json(*disk_free_bytes) : nlohmann::json()},
      {"stopping", progress.stopping}};
}

nlohmann::json frame_message(const LiveFrame& frame, HostTime begin) {
  const EstimateRow& row = frame.row;
  return {{"event", "frame"},
          {"index", row.frame_index},
          {"time_s", seconds(row.time, begin)},
          {"begin_s", seconds(row.exposure_begin, begin)},
          {"end_s", seconds(row.exposure_end, begin)},
          {"counted", row.counted},
          {"valid", frame.sample.valid},
          {"reasons", reason_texts(row.reason_bits)},
          {"excluded", row.counted ? nlohmann::json() : nlohmann::json(why_excluded(frame))},
          {"leg", row.leg},
          {"run", row.run},
          {"commanded_dps", number_json(row.rate_commanded_dps)},
          {"estimates", estimates_json(frame)},
          {"inference_us", number_json(frame.inference_us)},
          {"fresh", freshness(frame.frame)},
          {"scores", scores_json(frame.scores)}};
}

nlohmann::json image_message(const LiveFrame& frame, HostTime begin, bool mirrored) {
  std::vector<std::uint8_t> bytes;
  append_image(bytes, frame.frame.frame, mirrored);
  return {{"event", "image"},
          {"index", frame.row.frame_index},
          {"time_s", seconds(frame.row.time, begin)},
          {"pixels", base64(bytes)}};
}

nlohmann::json surroundings_message(std::span<const float> image_c, double time_s, double view_deg) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(2 * image_c.size());
  for (const float temp_c : image_c) append_hundredths(bytes, temp_c);
  return {{"event", "surroundings"},
          {"estimator", "odometer"},
          {"time_s", time_s},
          {"view_deg", number_json(view_deg)},
          {"columns", image_c.size() / frame_rows},
          {"pixels", base64(bytes)}};
}

nlohmann::json event_message(const RecordingEvent& event, HostTime begin) {
  return {{"event", "event"},
          {"time_s", seconds(event.time, begin)},
          {"kind", event_kind_names[static_cast<std::size_t>(event.kind)]},
          {"source", event.source ? std::string(thermorig::name_of(*event.source)) : "host"},
          {"message", event.message}};
}

nlohmann::json ended_message(const LiveEnd& end) {
  return {{"event", "ended"},
          {"exit", end.exit},
          {"message", end.message},
          {"advice", end.advice},
          {"session", text_json(end.session)}};
}

}  // namespace thermorig::app
