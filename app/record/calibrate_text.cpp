// SPDX-License-Identifier: MIT
#include "calibrate_text.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "print/number_json.h"
#include "print/output.h"

namespace thermorig::app {

namespace {

using calibration::BiasResult;
using calibration::EncoderResult;
using calibration::LatencyResult;
using calibration::LensResult;
using calibration::OrientationResult;
using calibration::ScaleResult;

std::string line(const std::string& name, const std::string& words) {
  return fmt::format("{:<12} {}\n", name, words);
}

std::string origin(const std::string& measured_utc) {
  return measured_utc.empty() ? "default, not measured" : "measured " + printable(measured_utc);
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
         line("", fmt::format("against the gyro; from {} half-frames", count_text(result.halves))) +
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
           line("servo scale", "not measured here: each session measures it, now that the gyro is known");
  return text + line("servo scale", scale_text(result.servo_scale->value, result.servo_scale->uncertainty)) +
         line("before", fmt::format("{}, {}", scale_text(servo.scale, servo.scale_uncertainty),
                                    origin(servo.scale_measured_utc)));
}

std::string words_of(const OrientationResult& result, const RigProfile& before) {
  return line("orientation", turning_text(result.gyro_axis, result.gyro_sign, result.mirrored)) +
         line("", fmt::format("correlation with the commanded speed {:.3f}; the image fits {:.0f} % better",
                              result.correlation, 100 * result.contrast)) +
         line("before",
              fmt::format("{}, {}", turning_text(before.gyro.axis, before.gyro.sign, before.camera.mirrored),
                          origin(before.camera.orientation_measured_utc)));
}

constexpr double good_pitch = 0.005;  // one standard deviation
constexpr const char* lens_not_told = "not measurable in these images: a plain lens is assumed";

/// "-1.30 +- 0.20 deg", of something that may not have been told; what is written, where that is another.
std::string told_text(const std::optional<Estimate>& told, double unit, int decimals,
                      const std::string& name) {
  if (!told) return lens_not_told;
  return fmt::format("{:+.{}f} +- {:.{}f}{}{}", unit * told->value, decimals, unit * told->uncertainty,
                     decimals, name, calibration::is_not_plain(*told) ? "" : ": taken as 0");
}

/// Logarithm of the likelihood over that of rows that are exposed all at once, by Wald's approximation.
double margin_of(const Estimate& row_spread) {
  return 0.5 * std::pow(row_spread.value / row_spread.uncertainty, 2);
}

std::string rows_text(const LensResult& result) {
  if (!result.row_spread) return lens_not_told;
  const Estimate& spread = *result.row_spread;
  const std::string margin =
      fmt::format("margin over all at once {:.0f} (difference of log-likelihoods)", margin_of(spread));
  if (!calibration::is_not_plain(spread))
    return fmt::format("exposed all at once ({:+.3f} +- {:.3f} of a refresh period); {}", spread.value,
                       spread.uncertainty, margin);
  return fmt::format(
      "exposed one after the other from the {} on, over {:.3f} +- {:.3f} of a refresh period; {}",
      spread.value > 0.0 ? "first" : "last", std::abs(spread.value), spread.uncertainty, margin);
}

std::string filter_text(const std::optional<Estimate>& delay_s) {
  if (!delay_s) return "as the profile has it";
  return fmt::format("delays by {:.1f} +- {:.1f} ms, by its noise", 1e3 * delay_s->value,
                     1e3 * delay_s->uncertainty);
}

std::string lens_before(const CameraProfile& camera) {
  return fmt::format("pitch {:.4f}, distortion {:+.3f}, tilt {:+.2f} deg, roll {:+.2f} deg, rows {:+.3f}, {}",
                     camera.pitch_scale, camera.distortion, camera.tilt_deg, camera.roll_deg,
                     camera.row_spread, origin(camera.lens_measured_utc));
}

std::string words_of(const LensResult& result, const RigProfile& before) {
  return line("pitch", fmt::format("{} of what a lens of {:g} degrees has",
                                   scale_text(result.pitch_scale.value, result.pitch_scale.uncertainty),
                                   before.camera.field_of_view_deg)) +
         line("", result.is_closed ? std::string("by a whole turn that closes: it owes nothing to the gyro")
                                   : std::string("no whole turn closes: as good as the gyro's scale")) +
         (result.pitch_scale.uncertainty > good_pitch
              ? line("",
                     "not to half a per cent: take another session where there is more to see, and give "
                     "both with --session")
              : std::string()) +
         line("distortion", told_text(result.distortion, 100.0, 2, " % in the corners")) +
         line("tilt", told_text(result.tilt_deg, 1.0, 2, " deg upward")) +
         line("roll", told_text(result.roll_deg, 1.0, 2, " deg, the side of growing angles up")) +
         line("rows", rows_text(result)) +
         line("", fmt::format("from {} half-frames in {:.0f} degrees of turning", count_text(result.halves),
                              result.turned_deg)) +
         line("gyro's filter", filter_text(result.gyro_delay_s)) + line("before", lens_before(before.camera));
}

std::string words_of(const EncoderResult& result, const RigProfile& before) {
  const EncoderProfile& old = before.encoder;
  return line("encoder",
              fmt::format("{}, {}", printable(result.sensor),
                          result.encoder.sign < 0 ? "turns against the command" : "turns with the command")) +
         line("errors", fmt::format("{:.3f} deg once a turn, {:.3f} deg twice; left of them {:.3f} deg",
                                    result.once_deg, result.twice_deg, result.encoder.error_deg)) +
         line("", fmt::format("from {} legs of {:.0f} degrees in all; a reading's noise is {:.3f} deg",
                              result.legs, result.turned_deg, result.noise_deg)) +
         line("zero", fmt::format("{:+.2f} deg by the command", result.encoder.offset_deg)) +
         line("gyro scale", scale_text(result.gyro_share.value, result.gyro_share.uncertainty) +
                                ", as corrected, by the encoder") +
         line("before",
              fmt::format("{:.3f} deg once, {:.3f} deg twice, {}",
                          std::hypot(old.once_cosine_deg, old.once_sine_deg),
                          std::hypot(old.twice_cosine_deg, old.twice_sine_deg), origin(old.measured_utc)));
}

nlohmann::json encoder_json(const EncoderProfile& encoder) {
  return {{"sign", encoder.sign},
          {"offset_deg", encoder.offset_deg},
          {"once_cosine_deg", encoder.once_cosine_deg},
          {"once_sine_deg", encoder.once_sine_deg},
          {"twice_cosine_deg", encoder.twice_cosine_deg},
          {"twice_sine_deg", encoder.twice_sine_deg},
          {"error_deg", encoder.error_deg}};
}

nlohmann::json object_of(const EncoderResult& result, const RigProfile& before) {
  nlohmann::json object{{"result", encoder_json(result.encoder)}, {"before", encoder_json(before.encoder)}};
  object["before"]["measured_utc"] = text_json(before.encoder.measured_utc);
  object["result"]["sensor"] = result.sensor;
  object["result"]["once_deg"] = result.once_deg;
  object["result"]["twice_deg"] = result.twice_deg;
  object["result"]["turned_deg"] = result.turned_deg;
  object["result"]["legs"] = result.legs;
  object["result"]["noise_deg"] = result.noise_deg;
  object["result"]["gyro_share"] = estimate_json(result.gyro_share);
  return object;
}

nlohmann::json measured(double value, double uncertainty, const std::string& utc) {
  nlohmann::json object = estimate_json(Estimate{value, uncertainty});
  object["measured_utc"] = text_json(utc);
  return object;
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
  object["result"]["servo_scale"] = estimate_json(result.servo_scale);
  return object;
}

nlohmann::json object_of(const LensResult& result, const RigProfile& before) {
  const CameraProfile& camera = before.camera;
  return {
      {"result",
       {{"pitch_scale", estimate_json(result.pitch_scale)},
        {"distortion", estimate_json(result.distortion)},
        {"tilt_deg", estimate_json(result.tilt_deg)},
        {"roll_deg", estimate_json(result.roll_deg)},
        {"row_spread", estimate_json(result.row_spread)},
        {"row_margin", result.row_spread ? nlohmann::json(margin_of(*result.row_spread)) : nlohmann::json()},
        {"turn_closes", result.is_closed},
        {"turned_deg", result.turned_deg},
        {"chess_halves", result.halves},
        {"gyro_delay_s", estimate_json(result.gyro_delay_s)}}},
      {"before",
       {{"pitch_scale", camera.pitch_scale},
        {"pitch_scale_uncertainty", camera.pitch_scale_uncertainty},
        {"distortion", camera.distortion},
        {"distortion_uncertainty", camera.distortion_uncertainty},
        {"tilt_deg", camera.tilt_deg},
        {"roll_deg", camera.roll_deg},
        {"row_spread", camera.row_spread},
        {"measured_utc", text_json(camera.lens_measured_utc)}}}};
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
