// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "thermorig/storage/recording_header/header_json.h"

namespace thermorig::tests {

// Headers as programs wrote them into journals and sessions before session format 2.0.

inline nlohmann::json format_1_link(const PortProfile& link) {
  return {{"port", link.port},
          {"usb_path", link.usb_path},
          {"baud", link.baud},
          {"latency_s", link.latency_s},
          {"latency_uncertainty_s", link.latency_uncertainty_s},
          {"latency_measured_utc", link.latency_measured_utc},
          {"largest_constant_delay_s", link.largest_constant_delay_s},
          {"wander_ppm", link.wander_ppm},
          {"reset_on_open", link.reset_on_open}};
}

inline nlohmann::json format_1_camera(const CameraProfile& camera) {
  constexpr std::array policies{"word", "byte", "ignore"};
  return {{"link", format_1_link(camera.link)},
          {"model", camera.model},
          {"output_rate_hz", camera.output_rate_hz},
          {"field_of_view_deg", camera.field_of_view_deg},
          {"mirrored", camera.mirrored},
          {"orientation_measured_utc", camera.orientation_measured_utc},
          {"checksum", policies.at(static_cast<std::size_t>(camera.checksum))}};
}

inline nlohmann::json format_1_gyro(const GyroProfile& gyro) {
  nlohmann::json object{{"link", format_1_link(gyro.link)},
                        {"model", gyro.model},
                        {"protocol", gyro.protocol},
                        {"text",
                         {{"prefix", gyro.text.prefix},
                          {"rate", gyro.text.rate},
                          {"scale_dps", gyro.text.scale_dps},
                          {"time", gyro.text.time},
                          {"time_unit_s", gyro.text.time_unit_s}}},
                        {"output_rate_hz", gyro.output_rate_hz},
                        {"axis", gyro.axis},
                        {"sign", gyro.sign},
                        {"scale", gyro.scale},
                        {"scale_uncertainty", gyro.scale_uncertainty},
                        {"scale_measured_utc", gyro.scale_measured_utc},
                        {"bias_dps", gyro.bias_dps},
                        {"bias_uncertainty_dps", gyro.bias_uncertainty_dps},
                        {"bias_measured_utc", gyro.bias_measured_utc}};
  if (!gyro.settings.empty()) object["settings"] = gyro.settings;
  return object;
}

inline nlohmann::json format_1_servo(const ServoProfile& servo) {
  return {{"link", format_1_link(servo.link)},
          {"model", servo.model},
          {"kind", servo.kind == ServoKind::positional   ? "positional"
                   : servo.kind == ServoKind::continuous ? "continuous"
                                                         : "none"},
          {"travel_deg", servo.travel_deg},
          {"full_rate_dps", servo.full_rate_dps},
          {"pulse_min_us", servo.pulse_min_us},
          {"pulse_max_us", servo.pulse_max_us},
          {"max_rate_dps", servo.max_rate_dps},
          {"acceleration_dps2", servo.acceleration_dps2},
          {"stop_margin_deg", servo.stop_margin_deg},
          {"settle_s", servo.settle_s},
          {"loop_hz", servo.loop_hz},
          {"scale", servo.scale},
          {"scale_uncertainty", servo.scale_uncertainty},
          {"scale_measured_utc", servo.scale_measured_utc}};
}

/// What a file of format 1 can hold of a profile.
inline RigProfile format_1_profile(RigProfile profile) {
  profile.gyro.bandwidth_hz = GyroProfile().bandwidth_hz;
  profile.gyro.filter_delay_s = GyroProfile().filter_delay_s;
  CameraProfile camera;  // nothing was known of its lens, and one protocol alone
  camera.link = profile.camera.link;
  camera.model = profile.camera.model;
  camera.output_rate_hz = profile.camera.output_rate_hz;
  camera.field_of_view_deg = profile.camera.field_of_view_deg;
  camera.mirrored = profile.camera.mirrored;
  camera.orientation_measured_utc = profile.camera.orientation_measured_utc;
  camera.checksum = profile.camera.checksum;
  profile.camera = camera;
  profile.servo.protocol = ServoProfile().protocol;
  profile.servo.bus_id = ServoProfile().bus_id;
  profile.encoder = {};
  return profile;
}

inline std::string format_1_header(const RecordingHeader& header) {
  nlohmann::json object = nlohmann::json::parse(recording_header::header_to_json_text(header));
  object["profile"] = {{"name", header.profile.name},
                       {"camera", format_1_camera(header.profile.camera)},
                       {"gyro", format_1_gyro(header.profile.gyro)},
                       {"servo", format_1_servo(header.profile.servo)}};
  object["profile_toml"] = "name = \"rig\"\n";
  return object.dump();
}

}  // namespace thermorig::tests
