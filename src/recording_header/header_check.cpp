// SPDX-License-Identifier: MIT
#include "header_check.h"

#include <algorithm>
#include <cmath>

#include "thermorig/core/nearest_name.h"
#include "thermorig/recording_header/header_json.h"
#include "thermorig/sensors/camera_protocol.h"
#include "thermorig/sensors/gyro_protocol.h"

namespace thermorig::recording_header {

namespace {

constexpr int text_columns_max = 63;
// Times of a session are sums of these: wide enough for any device, and no sum leaves the clock's range.
constexpr double longest_constant_s = 10.0;
constexpr double longest_settling_s = 3600.0;
constexpr int most_frames = 100;  // of any network's window
constexpr double slowest_hz = 1e-3, fastest_hz = 1e6;

bool is_environment_name(const std::string& name) {
  const auto allowed = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-'; };
  return !name.empty() && name.size() <= 32 && std::all_of(name.begin(), name.end(), allowed);
}

bool all_finite(std::initializer_list<double> values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

bool numbers_are_finite(const RigProfile& rig) {
  const auto& servo = rig.servo;
  return all_finite({rig.camera.output_rate_hz,
                     rig.camera.field_of_view_deg,
                     rig.gyro.output_rate_hz,
                     rig.gyro.text.scale_dps,
                     rig.gyro.text.time_unit_s,
                     servo.travel_deg,
                     servo.full_rate_dps,
                     servo.pulse_min_us,
                     servo.pulse_max_us,
                     servo.max_rate_dps,
                     servo.acceleration_dps2,
                     servo.stop_margin_deg,
                     servo.settle_s,
                     servo.loop_hz,
                     servo.scale,
                     servo.scale_uncertainty,
                     rig.gyro.scale,
                     rig.gyro.scale_uncertainty,
                     rig.gyro.bias_dps,
                     rig.gyro.bias_uncertainty_dps});
}

bool is_within(double value, double least, double most) {
  return value >= least && value <= most;
}

bool link_is_sound(const PortProfile& link) {
  return is_within(link.latency_s, -longest_constant_s, longest_constant_s) &&
         is_within(link.latency_uncertainty_s, 0.0, longest_constant_s) &&
         is_within(link.largest_constant_delay_s, 0.0, longest_constant_s) &&
         is_within(link.wander_ppm, 0.0, 1e6);
}

/// Scales divide, uncertainties weigh.
bool calibrations_are_sound(const RigProfile& rig) {
  return rig.gyro.scale > 0 && rig.servo.scale > 0 && rig.servo.loop_hz > 0 &&
         rig.gyro.scale_uncertainty >= 0 && rig.gyro.bias_uncertainty_dps >= 0 &&
         rig.servo.scale_uncertainty >= 0;
}

/// Its label scale divides, its frames are a window of rows; the rest is only told.
bool live_model_is_sound(const LiveModel& model) {
  return is_within(model.label_scale_dps, 1e-3, 1e6) && model.frames >= 0 && model.frames <= most_frames &&
         model.reduction >= 0;
}

bool is_column(int column) {
  return column >= -1 && column <= text_columns_max;
}

bool gyro_is_sound(const GyroProfile& gyro) {
  const auto& rate = gyro.text.rate;
  return gyro.axis >= 0 && gyro.axis <= 2 && (gyro.sign == 1 || gyro.sign == -1) &&
         is_column(gyro.text.time) && std::all_of(rate.begin(), rate.end(), is_column);
}

std::string unknown_protocol(const char* role, const std::string& name,
                             const std::vector<std::string>& known) {
  return std::string("it names a ") + role + " protocol \"" + name +
         "\" that is not known: " + advice_on_name(name, known);
}

/// Empty if the tables have the protocols of camera and gyro, and that of the gyro all of the settings.
std::string problem_of_protocols(const CameraProfile& camera, const GyroProfile& gyro) {
  if (sensors::find_camera_protocol(camera.protocol) == nullptr)
    return unknown_protocol("camera", camera.protocol, sensors::camera_protocol_names());
  const sensors::GyroProtocol* protocol = sensors::find_gyro_protocol(gyro.protocol);
  if (protocol == nullptr) return unknown_protocol("gyro", gyro.protocol, sensors::gyro_protocol_names());
  for (const auto& [name, value] : gyro.settings)
    if (!sensors::is_allowed(*protocol, name, value))
      return "the gyro's setting \"" + name + "\" is not one of its protocol, or out of range";
  return "";
}

}  // namespace

std::optional<std::string> problem_of(const RecordingHeader& header) {
  if (!is_environment_name(header.environment))
    return "the environment's name is not made of 1 to 32 of a-z, 0-9 and '-'";
  if (!header.licence.empty() && !is_licence(header.licence))
    return "the licence of the data is no line of up to 1000 bytes of UTF-8";
  if (!is_reference(header.time_reference)) return "it counts from a time that no host's clock shows";
  if (header.acquisition < 0 || header.frames_per_leg < 0)
    return "the acquisition number or the frames of a leg are negative";
  if (!numbers_are_finite(header.profile)) return "the profile holds a number that is not finite";
  for (const double rate_hz : {header.profile.camera.output_rate_hz, header.profile.gyro.output_rate_hz})
    if (!is_within(rate_hz, slowest_hz, fastest_hz))
      return "the profile holds a rate that is not positive, or one that no device has";
  if (!is_within(header.profile.servo.settle_s, 0.0, longest_settling_s))
    return "the profile holds a settling time that is negative or longer than an hour";
  for (const Device device : all_devices)
    if (!link_is_sound(header.profile.link(device)))
      return "the profile holds a latency, a delay or a wander that is not a sound number";
  if (!calibrations_are_sound(header.profile))
    return "the profile holds a scale or a loop's bandwidth that is not positive, or a negative uncertainty";
  if (!gyro_is_sound(header.profile.gyro)) return "the gyro's axis, sign or columns are out of range";
  if (std::string problem = problem_of_protocols(header.profile.camera, header.profile.gyro);
      !problem.empty())
    return problem;
  if (!live_model_is_sound(header.live_model)) return "the live model's label scale or shape is out of range";
  return std::nullopt;
}

}  // namespace thermorig::recording_header
