// SPDX-License-Identifier: MIT
#include <nlohmann/json.hpp>

#include "number_json.h"
#include "timing_remarks.h"
#include "timing_text.h"

namespace thermorig::app {

namespace {

nlohmann::json gaps_json(const ClockReport& clock, HostTime start) {
  nlohmann::json gaps = nlohmann::json::array();
  for (const ClockGap& gap : clock.gaps)
    gaps.push_back(
        {{"begin_s", to_s(gap.begin - start)}, {"end_s", to_s(gap.end - start)}, {"missing", gap.missing}});
  return gaps;
}

nlohmann::json epochs_json(const ClockReport& clock, HostTime start) {
  nlohmann::json epochs = nlohmann::json::array();
  for (const ClockEpoch& epoch : clock.epochs)
    epochs.push_back({{"begin_s", to_s(epoch.begin - start)}, {"reason", epoch.reason}});
  return epochs;
}

nlohmann::json clock_json(const ClockReport& clock, HostTime start) {
  return {{"method", clock.method},
          {"rate_hz", clock.rate_hz},
          {"skew_ppm", clock.skew_ppm},
          {"wander_ppm", clock.wander_ppm},
          {"late_p50_us", clock.late_p50_us},
          {"late_p95_us", clock.late_p95_us},
          {"late_max_us", clock.late_max_us},
          {"uncertainty_us", clock.uncertainty_us},
          {"bound_median_us", clock.bound_median_us},
          {"bound_max_us", clock.bound_us},
          {"bound_wander_ppm", clock.bound_wander_ppm},
          {"lower_bound_is_proof", clock.method == "two-way" && clock.bound_wander_ppm > 0.0},
          {"largest_constant_delay_s", clock.largest_constant_delay_s},
          {"latency_s", clock.latency_s},
          {"latency_uncertainty_s", clock.latency_uncertainty_s},
          {"gaps", gaps_json(clock, start)},
          {"epochs", epochs_json(clock, start)}};
}

nlohmann::json offset_json(const CameraOffset& offset) {
  return {{"offset_s", estimate_json(offset.offset_s)},
          {"why_not", offset.why_not},
          {"chess_halves", offset.halves},
          {"contradicts_calibration", offset.contradicts},
          {"row_delay_s", estimate_json(offset.row_delay_s)},
          {"applied", offset.applied}};
}

nlohmann::json course_json(const std::vector<BiasKnot>& course, HostTime start) {
  nlohmann::json knots = nlohmann::json::array();
  for (const BiasKnot& knot : course)
    knots.push_back({{"time_s", to_s(knot.time - start)}, {"bias_dps", knot.bias_dps}});
  return knots;
}

nlohmann::json gyro_json(const GyroErrors& gyro, HostTime start) {
  return {{"scale", estimate_json(gyro.scale)},
          {"scale_calibrated", gyro.scale_calibrated},
          {"scale_by_turns", estimate_json(gyro.scale_by_turns)},
          {"scale_why_not", gyro.scale_why_not},
          {"scale_contradicts_calibration", gyro.scale_contradicts},
          {"filter_delay_s", estimate_json(gyro.filter_delay_s)},
          {"filter_source", gyro.filter_source},
          {"filter_contradicts_profile", gyro.filter_contradicts},
          {"bias_dps", estimate_json(gyro.bias_dps)},
          {"bias_course", course_json(gyro.bias_course, start)},
          {"bias_before_dps", number_json(gyro.bias_before_dps)},
          {"bias_after_dps", number_json(gyro.bias_after_dps)},
          {"noise_dps", gyro.noise_dps},
          {"zeroes_itself", gyro.zeroes_itself}};
}

nlohmann::json servo_json(const ServoResponse& servo) {
  nlohmann::json speeds = nlohmann::json::array();
  for (const ServoResponse::AtSpeed& speed : servo.speeds)
    speeds.push_back({{"rate_dps", speed.rate_dps},
                      {"residual_dps", speed.residual_dps},
                      {"spread_dps", speed.spread_dps},
                      {"reached_dps", number_json(speed.reached_dps)},
                      {"contradicts_command", speed.contradicts},
                      {"frames", speed.frames}});
  return {{"fitted", servo.fitted},
          {"delay_s", servo.delay_s},
          {"delay_uncertainty_s", servo.delay_uncertainty_s},
          {"loop_hz", servo.loop_hz},
          {"scale", estimate_json(servo.scale)},
          {"scale_calibrated", servo.scale_calibrated},
          {"residual_dps", servo.residual_dps},
          {"speeds", speeds}};
}

nlohmann::json witnesses_json(const Witnesses& witnesses) {
  return {{"gyro_share", estimate_json(witnesses.gyro_share)},
          {"images_share", estimate_json(witnesses.images_share)},
          {"images_why_not", witnesses.images_why_not},
          {"outlier", name_of(witnesses.outlier)},
          {"cause", witnesses.cause},
          {"remedy", witnesses.remedy}};
}

}  // namespace

nlohmann::json timing_json(const session::Session& session, const session::Quality& quality) {
  if (!has_timing(session)) return nullptr;
  const HostTime start = session.raw.header.time_reference;
  nlohmann::json clocks;
  for (const Device device : all_devices)
    clocks[std::string(name_of(device))] = clock_json(session.sync.clock[device], start);
  const TimingRemarks remarks = timing_remarks(session);
  return {{"clock", clocks},
          {"camera_offset", offset_json(session.sync.camera_offset)},
          {"gyro", gyro_json(session.sync.gyro, start)},
          {"servo", servo_json(session.sync.servo)},
          {"witnesses", witnesses_json(session.sync.witnesses)},
          {"rate_shaft_uncertainty_dps", quality.rate_shaft_uncertainty_dps},
          {"gyro_residual_dps", quality.gyro_residual_dps},
          {"verdict", quality.verdict},
          {"verdict_reasons", quality.verdict_reasons},
          {"remarks", remarks.sentences},
          {"advice", remarks.advice}};
}

}  // namespace thermorig::app
