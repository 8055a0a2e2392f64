// SPDX-License-Identifier: MIT
#include "calibrate_text.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "print/number_json.h"
#include "print/output.h"

namespace thermorig::app {

namespace {

using calibration::BiasResult;
using calibration::LatencyResult;
using calibration::OrientationResult;
using calibration::ScaleResult;

std::string line(const std::string& name, const std::string& words) {
  return fmt::format("{:<12} {}\n", name, words);
}

std::string origin(const std::string& measured_utc) {
  return measured_utc.empty() ? "an assumption" : "measured " + printable(measured_utc);
}

std::string ms_text(double value_s, double uncertainty_s) {
  return fmt::format("{:.2f} +- {:.2f} ms", 1e3 * value_s, 1e3 * uncertainty_s);
}

std::string dps_text(double value_dps, double uncertainty_dps) {
  return fmt::format("{:+.3f} +- {:.3f} deg/s", value_dps, uncertainty_dps);
}

std::string scale_text(double value, double uncertainty) {
  return fmt::format("{:.5f} +- {:.5f} ({:+.2f} +- {:.2f} %)", value, uncertainty, 100 * (value - 1),
                     100 * uncertainty);
}

std::string turning_text(int axis, int sign, bool mirrored) {
  return fmt::format("gyro axis {}{}, image {}", sign < 0 ? "-" : "+", "xyz"[axis],
                     mirrored ? "mirrored" : "not mirrored");
}

std::string words_of(const BiasResult& result, const RigProfile& before) {
  const GyroProfile& gyro = before.gyro;
  return line("gyro bias", dps_text(result.bias_dps.value, result.bias_dps.uncertainty)) +
         line("",
              fmt::format("from {:.0f} s at rest, in which it drifted by {:+.3f} deg/s; a sample's noise is "
                          "{:.3f} deg/s",
                          result.rest_s, result.drift_dps, result.noise_dps)) +
         line("before", fmt::format("{}, {}", dps_text(gyro.bias_dps, gyro.bias_uncertainty_dps),
                                    origin(gyro.bias_measured_utc)));
}

std::string words_of(const LatencyResult& result, const RigProfile& before) {
  const PortProfile& link = before.camera.link;
  return line("camera",
              fmt::format("its first byte comes {} after the end of the exposure",
                          ms_text(result.camera_latency_s.value, result.camera_latency_s.uncertainty))) +
         line("", fmt::format("as the gyro tells time; from {} chess halves", count_text(result.halves))) +
         line("before", fmt::format("{}, {}", ms_text(link.latency_s, link.latency_uncertainty_s),
                                    origin(link.latency_measured_utc)));
}

std::string words_of(const ScaleResult& result, const RigProfile& before) {
  const GyroProfile& gyro = before.gyro;
  const ServoProfile& servo = before.servo;
  std::string text = line("gyro scale", scale_text(result.gyro_scale.value, result.gyro_scale.uncertainty)) +
                     line("", fmt::format("from {:.1f} degrees of turning", result.turned_deg)) +
                     line("before", fmt::format("{}, {}", scale_text(gyro.scale, gyro.scale_uncertainty),
                                                origin(gyro.scale_measured_utc)));
  if (!result.servo_scale)
    return text +
           line("servo scale", "not measured here: every session tells it, now that the gyro is known");
  return text + line("servo scale", scale_text(result.servo_scale->value, result.servo_scale->uncertainty)) +
         line("before", fmt::format("{}, {}", scale_text(servo.scale, servo.scale_uncertainty),
                                    origin(servo.scale_measured_utc)));
}

std::string words_of(const OrientationResult& result, const RigProfile& before) {
  return line("orientation", turning_text(result.gyro_axis, result.gyro_sign, result.mirrored)) +
         line("",
              fmt::format("the axis follows the commands by {:.3f} of 1, the image fits better by {:.0f} %",
                          result.correlation, 100 * result.contrast)) +
         line("before",
              fmt::format("{}, {}", turning_text(before.gyro.axis, before.gyro.sign, before.camera.mirrored),
                          origin(before.camera.orientation_measured_utc)));
}

nlohmann::json measured(double value, double uncertainty, const std::string& utc) {
  nlohmann::json object{{"value", value}, {"uncertainty", uncertainty}};
  object["measured_utc"] = text_json(utc);
  return object;
}

nlohmann::json estimate_json(const Estimate& estimate) {
  return {{"value", estimate.value}, {"uncertainty", estimate.uncertainty}};
}

nlohmann::json object_of(const BiasResult& result, const RigProfile& before) {
  const GyroProfile& gyro = before.gyro;
  return {
      {"result",
       {{"bias_dps", estimate_json(result.bias_dps)},
        {"noise_dps", result.noise_dps},
        {"drift_dps", result.drift_dps},
        {"rest_s", result.rest_s}}},
      {"before", {{"bias_dps", measured(gyro.bias_dps, gyro.bias_uncertainty_dps, gyro.bias_measured_utc)}}}};
}

nlohmann::json object_of(const LatencyResult& result, const RigProfile& before) {
  const PortProfile& link = before.camera.link;
  return {{"result",
           {{"camera_latency_s", estimate_json(result.camera_latency_s)}, {"chess_halves", result.halves}}},
          {"before",
           {{"camera_latency_s",
             measured(link.latency_s, link.latency_uncertainty_s, link.latency_measured_utc)}}}};
}

nlohmann::json object_of(const ScaleResult& result, const RigProfile& before) {
  const GyroProfile& gyro = before.gyro;
  const ServoProfile& servo = before.servo;
  nlohmann::json object{
      {"result", {{"gyro_scale", estimate_json(result.gyro_scale)}, {"turned_deg", result.turned_deg}}},
      {"before",
       {{"gyro_scale", measured(gyro.scale, gyro.scale_uncertainty, gyro.scale_measured_utc)},
        {"servo_scale", measured(servo.scale, servo.scale_uncertainty, servo.scale_measured_utc)}}}};
  object["result"]["servo_scale"] =
      result.servo_scale ? estimate_json(*result.servo_scale) : nlohmann::json();
  return object;
}

nlohmann::json turning_json(int axis, int sign, bool mirrored) {
  return {{"gyro_axis", std::string(1, "xyz"[axis])}, {"gyro_sign", sign}, {"mirrored", mirrored}};
}

nlohmann::json object_of(const OrientationResult& result, const RigProfile& before) {
  nlohmann::json object{{"result", turning_json(result.gyro_axis, result.gyro_sign, result.mirrored)},
                        {"before", turning_json(before.gyro.axis, before.gyro.sign, before.camera.mirrored)}};
  object["result"]["correlation"] = result.correlation;
  object["result"]["contrast"] = result.contrast;
  const std::string& utc = before.camera.orientation_measured_utc;
  object["before"]["measured_utc"] = text_json(utc);
  return object;
}

}  // namespace

std::string text_of(const CalibrationResult& result, const RigProfile& before) {
  return std::visit([&](const auto& found) { return words_of(found, before); }, result);
}

nlohmann::json calibration_json(const CalibrationResult& result, const RigProfile& before) {
  return std::visit([&](const auto& found) { return object_of(found, before); }, result);
}

}  // namespace thermorig::app
