// SPDX-License-Identifier: MIT
// One simulated rig in its world, used as a user would, and its session against the truth: one JSON object.
// What hard_table.py makes its rows of.
// Usage: hard_case SEED ENVIRONMENT WORLD [WORLD-OF-THE-CALIBRATIONS [CAMERA]]
//                  [--encoder | --servo PROTOCOL] | --knobs
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "hard_truth.h"
#include "hard_user.h"
#include "simulation/world_knobs.h"
#include "thermorig/core/statistics.h"

namespace {

using namespace thermorig;
using nlohmann::json;

json knobs_json() {
  json knobs = json::array();
  for (const simulation::Knob& knob : simulation::world_knobs())
    knobs.push_back({{"name", knob.name}, {"honest", knob.honest()}, {"low", knob.low}, {"high", knob.high}});
  return knobs;
}

json estimate_json(const Estimate& estimate) {
  return {estimate.value, estimate.uncertainty};
}

/// Sizes of the errors as so many quantiles, in ms: what thousands of samples need for a percentile of
/// several sessions together.
json quantiles_json(std::vector<double> errors_s) {
  constexpr std::size_t quantiles = 500;
  for (double& error : errors_s) error = std::abs(error);
  std::sort(errors_s.begin(), errors_s.end());
  json list = json::array();
  for (std::size_t i = 0; i < quantiles && !errors_s.empty(); ++i)
    list.push_back(1e3 * errors_s[(2 * i + 1) * errors_s.size() / (2 * quantiles)]);
  return list;
}

json times_json(const bench::TimeErrors& errors) {
  double sum_s = 0.0;
  for (const double error : errors.errors_s) sum_s += error;
  const auto count = static_cast<double>(errors.errors_s.size());
  return {{"samples", errors.errors_s.size()},
          {"median_width_ms", errors.widths_s.empty() ? json() : json(1e3 * median(errors.widths_s))},
          {"outside", errors.outside},
          {"mean_ms", errors.errors_s.empty() ? json() : json(1e3 * sum_s / count)},
          {"quantiles_ms", quantiles_json(errors.errors_s)}};
}

json said_json(const session::Session& session) {
  json said = json::array();
  for (const RecordingEvent& event : session.raw.events)
    if (event.kind == EventKind::warning) said.push_back(event.message);
  return said;
}

/// What the session states of itself, beside what its profile said before: for whoever looks into a row.
json stated_json(const session::Session& session) {
  const SyncReport& sync = session.sync;
  const RigProfile& profile = session.raw.header.profile;
  json stated = {{"gyro_scale", estimate_json(sync.gyro.scale)},
                 {"servo_scale", estimate_json(sync.servo.scale)},
                 {"gyro_ratio", estimate_json(sync.servo.gyro_ratio)},
                 {"servo_fitted", sync.servo.fitted},
                 {"loop_hz", sync.servo.loop_hz},
                 {"residual_dps", sync.servo.residual_dps},
                 {"camera_latency_ms",
                  {1e3 * profile.camera.link.latency_s, 1e3 * profile.camera.link.latency_uncertainty_s}}};
  stated["ripples"] = json::array();
  for (const ServoResponse::Ripple& ripple : sync.servo.ripples)
    stated["ripples"].push_back({{"period_deg", ripple.period_deg},
                                 {"forward", std::hypot(ripple.forward_cosine, ripple.forward_sine)},
                                 {"backward", std::hypot(ripple.backward_cosine, ripple.backward_sine)}});
  if (sync.camera_offset.offset_s)
    stated["camera_offset_ms"] = {1e3 * sync.camera_offset.offset_s->value,
                                  1e3 * sync.camera_offset.offset_s->uncertainty};
  if (sync.gyro.bias_dps) stated["bias_dps"] = estimate_json(*sync.gyro.bias_dps);
  if (sync.gyro.bias_before_dps) stated["bias_before_dps"] = *sync.gyro.bias_before_dps;
  if (sync.gyro.bias_after_dps) stated["bias_after_dps"] = *sync.gyro.bias_after_dps;
  return stated;
}

void add_session(const bench::HardRecording& made, json& object) {
  const session::Session& session = *made.session;
  const simulation::VirtualRig& rig = made.bus->rig;
  object["message"] = made.result.message;
  object["verdict"] = made.result.quality.verdict;
  object["verdict_reasons"] = made.result.quality.verdict_reasons;
  object["warnings"] = said_json(session);
  object["reasons"] = made.result.quality.reason_counts;
  object["stated"] = stated_json(session);
  object["speeds"] = json::array();
  for (const session::Quality::Speed& speed : made.result.quality.speeds)
    object["speeds"].push_back(
        {{"rate_dps", speed.rate_dps}, {"frames", speed.frames}, {"valid", speed.valid}});
  object["shaft"] = {{"used", session.sync.shaft.used}, {"why_not", session.sync.shaft.why_not}};
  object["speeds_without_frames_dps"] = json::array();
  for (const session::Quality::Speed& speed : made.result.quality.speeds)
    if (speed.valid == 0) object["speeds_without_frames_dps"].push_back(speed.rate_dps);
  const auto gyro_scale = bench::true_gyro_scale(session, rig);
  object["true_gyro_scale"] = gyro_scale ? json(*gyro_scale) : json();
  const bench::LabelErrors labels = bench::label_errors(session, rig);
  object["labels"] = {{"frames", labels.frames},
                      {"useless", labels.useless},
                      {"rejected_useless", labels.rejected_useless},
                      {"shaft_dps", labels.shaft_dps},
                      {"uncertainty_dps", labels.uncertainty_dps},
                      {"commanded_dps", labels.commanded_dps},
                      {"commanded_uncertainty_dps", labels.commanded_uncertainty_dps},
                      {"corrected_dps", labels.corrected_dps},
                      {"corrected_uncertainty_dps", labels.corrected_uncertainty_dps}};
  const bench::LiveServoTimes live = bench::live_servo_times(session, rig);
  object["live_servo"] = {{"samples", live.errors.errors_s.size()},
                          {"outside", live.errors.outside},
                          {"median_width_ms", 1e3 * live.median_width_s}};
  const auto times = bench::time_errors(session, rig);
  for (const Device device : all_devices)
    object["times"][std::string(name_of(device))] = times_json(times[device]);
}

json case_json(const bench::HardCase& hard) {
  const bench::HardRecording made = bench::use(hard);
  json object = {{"seed", hard.seed},
                 {"environment", hard.environment},
                 {"world", simulation::text_of(simulation::world_named(hard.world, hard.seed))},
                 {"refusal", made.refusal},
                 {"refused_calibrations", json::array()}};
  for (const auto& [name, why] : made.refused_calibrations)
    object["refused_calibrations"].push_back({{"name", name}, {"why", why}});
  if (made.session) add_session(made, object);
  return object;
}

}  // namespace

int main(int count, char** arguments) {
  if (count == 2 && std::string(arguments[1]) == "--knobs") {
    fmt::print("{}\n", knobs_json().dump());
    return 0;
  }
  const bool has_encoder = std::string(arguments[count - 1]) == "--encoder";
  if (has_encoder) --count;
  const bool has_other_servo = count > 5 && std::string(arguments[count - 2]) == "--servo";
  const std::string servo = has_other_servo ? arguments[count - 1] : ServoProfile().protocol;
  if (has_other_servo) count -= 2;
  if (count < 4 || count > 6) {
    fmt::print(stderr,
               "usage: hard_case SEED ENVIRONMENT WORLD [WORLD-OF-THE-CALIBRATIONS [CAMERA]] [--encoder | "
               "--servo PROTOCOL] | --knobs\n");
    return 2;
  }
  try {
    const std::string world = arguments[3];
    fmt::print("{}\n", case_json({.seed = std::strtoull(arguments[1], nullptr, 10),
                                  .environment = arguments[2],
                                  .world = world,
                                  .calibrated_in = count > 4 ? arguments[4] : world,
                                  .camera = count > 5 ? arguments[5] : "half",
                                  .has_encoder = has_encoder,
                                  .servo = servo})
                           .dump());
  } catch (const std::exception& error) {
    fmt::print(stderr, "hard_case: {}\n", error.what());
    return 1;
  }
  return 0;
}
