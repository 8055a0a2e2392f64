// SPDX-License-Identifier: MIT
// One simulated recording as the odometer goes through it, for the pictures of docs/odometer.md: one JSON
// object. Usage: odometer_pictures [SEED ENVIRONMENT]
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "odometer_recording.h"
#include "thermorig/estimators/odometer/odometer.h"

namespace thermorig::bench {
namespace {

using nlohmann::json;

constexpr double in_motion_s = 12.0;  // after the opening rest: it starts in the first leg
constexpr std::array<double, 3> maps_s{9.0, 30.0, 120.0};

/// Variance of its pixels.
double contrast_of(const ThermalFrame& frame) {
  double sum = 0.0, squares = 0.0;
  for (const float temp_c : frame.temp_c) sum += double{temp_c}, squares += double{temp_c} * double{temp_c};
  return squares / frame_pixels - sum / frame_pixels * sum / frame_pixels;
}

json picture_of(const OdometerRecording& recording) {
  odometer::Odometer odometer(recording.profile.gyro, recording.profile.camera);
  const HostTime begin = recording.measurements.front().frame.exposure_end + from_s(in_motion_s);
  json rows = json::array(), maps = json::array(), frame;
  double gyro_deg = 0.0, first_shaft_deg = 0.0, most_contrast = 0.0;
  std::optional<HostTime> last_sample;
  for (const Measurement& measurement : recording.measurements) {
    const double time_s = to_s(measurement.frame.exposure_end - begin);
    if (time_s < 0.0) continue;
    const double shaft = shaft_deg(recording, measurement.frame.exposure_end);
    if (rows.empty()) first_shaft_deg = shaft;
    for (const TimedGyro& sample : measurement.gyro) {
      if (last_sample && !rows.empty())
        gyro_deg += double{sample.rate_dps} * to_s(sample.stamp.time - *last_sample);
      last_sample = sample.stamp.time;
    }
    const odometer::Report report = odometer.add(measurement.frame, measurement.gyro);
    rows.push_back({time_s, shaft - first_shaft_deg, gyro_deg, static_cast<int>(report.state),
                    report.heading_deg, report.heading_sigma_deg, report.innovation_deg,
                    report.innovation_sigma_deg, report.bias_dps, report.scale});
    const bool is_next = maps.size() < maps_s.size() && time_s >= maps_s[maps.size()];
    // Of the last one the frame of the seconds after that shows most: walls show nothing.
    const double contrast = contrast_of(measurement.frame.frame);
    const bool is_better =
        maps.size() == maps_s.size() && time_s < maps_s.back() + 20.0 && contrast > most_contrast;
    if (!is_next && !is_better) continue;
    if (is_better) maps.erase(maps.end() - 1);
    maps.push_back(
        {{"time_s", time_s}, {"heading_deg", report.heading_deg}, {"temp_c", odometer.map_image_c()}});
    frame = measurement.frame.frame.temp_c;
    most_contrast = contrast;
  }
  return {{"columns",
           {"time_s", "shaft_deg", "gyro_deg", "state", "heading_deg", "heading_sigma_deg", "innovation_deg",
            "innovation_sigma_deg", "bias_dps", "scale"}},
          {"rows", rows},
          {"maps", maps},
          {"newest_frame", frame},
          {"mirrored", recording.profile.camera.mirrored}};
}

}  // namespace
}  // namespace thermorig::bench

int main(int count, char** arguments) {
  using namespace thermorig::bench;
  OdometerCase wanted{.seed = 7003, .environment = "kitchen"};
  if (count == 3) {
    wanted.seed = std::strtoull(arguments[1], nullptr, 10);
    wanted.environment = arguments[2];
  } else if (count != 1) {
    fmt::print(stderr, "usage: odometer_pictures [SEED ENVIRONMENT]\n");
    return 2;
  }
  fmt::print("{}\n", picture_of(record(wanted)).dump());
  return 0;
}
