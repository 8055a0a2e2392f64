// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "protocol_table.h"
#include "text_line.h"
#include "text_words.h"
#include "thermorig/sensors/gyro_protocol.h"
#include "thermorig/sensors/gyro_sketch.h"

namespace thermorig::sensors {

namespace {

constexpr double mpu6050_counts = 1.0 / 131.0;  // deg/s, at +-250 deg/s, its setting after a reset
constexpr double usual_noise_dps = 0.05;        // rms of an MPU-6050: PS-MPU-6000A-00, table 6.1
constexpr double itg3200_counts = 1.0 / 14.375;
constexpr double usual_frames_hz = 8.0;
constexpr std::string_view takes_bias_off =
    "it measures the bias when it starts (keep it still then) and subtracts it from what it sends";

TextColumns columns(std::string_view prefix, std::array<int, 3> rate, double scale_dps) {
  return {.prefix = std::string(prefix), .rate = rate, .scale_dps = scale_dps};
}

/// Marks that hold another one stand before it.
std::vector<GyroSketch> made_sketches() {
  GyroSketch razor_m0{.name = "sparkfun-razor-m0",
                      .title = "SparkFun 9DoF Razor M0",
                      .prints = "deg/s",
                      .columns = columns("", {4, 5, 6}, 1.0),
                      .baud = 0,
                      .rate_hz = 100.0,
                      .bandwidth_hz = 5.0,
                      .remark =
                          "its motion processor takes a bias off the rates while it rests, and its "
                          "low-pass of 5 Hz is slow: turn both off in its firmware"};
  razor_m0.columns.time = 0;
  return {
      {.name = "i2cdevlib-mpu6050",
       .title = "i2cdevlib, MPU6050_raw",
       .prints = "counts at +-250 deg/s",
       .columns = columns("a/g:", {3, 4, 5}, mpu6050_counts),
       .baud = 38400,
       .rate_hz = 10.0,
       .mark = "a/g:",
       .mark_tells_unit = true,
       .first_number = 3,
       .gravity = 16384.0},
      {.name = "adafruit-mpu6050",
       .title = "Adafruit_MPU6050, basic_readings",
       .prints = "rad/s",
       .columns = columns("Rotation", {1, 3, 5}, dps_of_rad_s),
       .rate_hz = 2.0,
       .decimals = 2,
       .mark = "Rotation X: "},
      {.name = "adafruit-mpu6050-plotter",
       .title = "Adafruit_MPU6050, plotter",
       .prints = "rad/s",
       .columns = columns("", {3, 4, 5}, dps_of_rad_s),
       .rate_hz = 100.0,
       .decimals = 2,
       .mark = "AccelX:",
       .mark_tells_unit = true,
       .gravity = 9.81},
      {.name = "adafruit-lsm6ds",
       .title = "Adafruit_LSM6DS",
       .prints = "rad/s",
       .columns = columns("\t\tGyro", {1, 3, 5}, dps_of_rad_s),
       .rate_hz = 10.0,
       .decimals = 2,
       .mark = "\t\tGyro X: "},
      {.name = "adafruit-unified",
       .title = "Adafruit's unified sensors, plotter form",
       .prints = "rad/s",
       .columns = columns("", {4, 5, 6}, dps_of_rad_s),
       .rate_hz = 100.0,
       .decimals = 2},
      {.name = "adafruit-bno055",
       .title = "Adafruit_BNO055, read_all_data",
       .prints = "rad/s",
       .columns = columns("Gyro:", {1, 4, 7}, dps_of_rad_s),
       .rate_hz = 10.0,
       .decimals = 2,
       .mark = "Gyro:\tx=",
       .mark_tells_unit = true},
      {.name = "adafruit-bno08x",
       .title = "Adafruit_BNO08x, more_reports",
       .prints = "rad/s",
       .columns = columns("Gyro - ", {1, 3, 5}, dps_of_rad_s),
       .rate_hz = 100.0,
       .decimals = 2,
       .mark = "Gyro - x:",
       .mark_tells_unit = true},
      {.name = "sparkfun-bno080",
       .title = "SparkFun BNO080, Example3",
       .prints = "rad/s",
       .columns = columns("", {0, 1, 2}, dps_of_rad_s),
       .rate_hz = 20.0,
       .decimals = 2,
       .mark = "in form x, y, z, in radians per second"},
      {.name = "arduino-imu",
       .title = "Arduino, SimpleGyroscope",
       .prints = "deg/s",
       .columns = columns("", {0, 1, 2}, 1.0),
       .baud = 0,
       .rate_hz = 104.0,
       .mark = "Gyroscope in degrees/second"},
      {.name = "sparkfun-icm20948",
       .title = "SparkFun ICM-20948, Example1",
       .prints = "deg/s",
       .columns = columns("Scaled. ", {10, 11, 12}, 1.0),
       .rate_hz = 30.0,
       .mark = "Scaled. Acc ("},
      {.name = "sparkfun-icm20948-raw",
       .title = "SparkFun ICM-20948, raw",
       .prints = "counts at +-250 deg/s",
       .columns = columns("RAW. ", {8, 9, 10}, mpu6050_counts),
       .rate_hz = 30.0,
       .mark = "RAW. Acc [",
       .mark_tells_unit = true},
      {.name = "sparkfun-bmi270",
       .title = "SparkFun BMI270, Example1",
       .prints = "deg/s",
       .columns = columns("", {13, 15, 17}, 1.0),
       .rate_hz = 50.0,
       .mark = "Acceleration in g's\tX: "},
      {.name = "tockn-mpu6050",
       .title = "MPU6050_tockn",
       .prints = "deg/s",
       .columns = columns("gyroX", {1, 4, 7}, 1.0),
       .baud = 9600,
       .rate_hz = 1.0,
       .remark = takes_bias_off,
       .mark = "gyroX :",
       .mark_tells_unit = true},
      {.name = "mpu6050-light",
       .title = "MPU6050_light",
       .prints = "deg/s",
       .columns = columns("GYRO", {1, 3, 5}, 1.0),
       .baud = 9600,
       .rate_hz = 1.0,
       .remark = takes_bias_off,
       .mark = "GYRO      X:",
       .mark_tells_unit = true},
      {.name = "bolderflight-imu",
       .title = "Bolder Flight invensense-imu",
       .prints = "rad/s",
       .columns = columns("", {5, 6, 7}, dps_of_rad_s),
       .rate_hz = 50.0,
       .decimals = 2},
      razor_m0,
      {.name = "razor-ahrs",
       .title = "Razor AHRS, #osct",
       .prints = "counts of an ITG-3200",
       .columns = columns("#G-C=", {0, 1, 2}, itg3200_counts),
       .baud = 57600,
       .rate_hz = 50.0,
       .mark = "#G-",
       .mark_tells_unit = true,
       .first_number = 0},
      {.title = "OpenLog Artemis",
       .prints = "deg/s",
       .columns = columns("", {-1, -1, -1}, 1.0),
       .mark = "aX,aY,aZ,gX,gY,gZ",
       .mark_tells_unit = true},
  };
}

bool is_same_scale(double a, double b) {
  return std::abs(a / b - 1.0) < 0.01;
}

bool read_alike(const TextColumns& a, const TextColumns& b, const std::string& line) {
  std::string room;
  const auto one = read_text_line(a, line, room).reading, other = read_text_line(b, line, room).reading;
  return !one || !other ||
         std::equal(one->rate_dps.begin(), one->rate_dps.end(), other->rate_dps.begin(),
                    [](float x, float y) { return std::abs(x - y) <= 1e-3F + 0.01F * std::abs(x); });
}

}  // namespace

std::span<const GyroSketch> gyro_sketches() {
  static const std::vector<GyroSketch> table = made_sketches();
  return table;
}

const GyroSketch* find_gyro_sketch(std::string_view name) {
  return name.empty() ? nullptr : find_in(gyro_sketches(), name);
}

std::vector<std::string> gyro_names() {
  std::vector<std::string> names = gyro_protocol_names();
  for (const GyroSketch& sketch : gyro_sketches())
    if (!sketch.name.empty()) names.emplace_back(sketch.name);
  return names;
}

void choose_gyro(std::string_view name, GyroProfile& profile) {
  if (const GyroSketch* sketch = find_gyro_sketch(name)) {
    profile.protocol = "text";
    profile.sketch = sketch->name;
    profile.model = sketch->title;
    profile.settings.clear();
    profile.text = sketch->columns;
    profile.link.baud = sketch->baud;
    profile.output_rate_hz = sketch->rate_hz;
    profile.bandwidth_hz = sketch->bandwidth_hz;
    return;
  }
  if (find_gyro_protocol(name) == nullptr)
    throw Error(ExitCode::bad_usage, fmt::format("the gyro \"{}\" is not known", name), "--gyro-protocol",
                advice_on_name(std::string(name), gyro_names()));
  profile.sketch.clear();
  if (profile.protocol == name) return;
  profile.protocol = name;
  profile.model = name;
  profile.settings.clear();
  profile.output_rate_hz = gyro_protocol(name).usual_rate_hz;
}

std::string contradiction(const GyroProfile& profile, const TextFormat& format) {
  const GyroSketch* sketch = find_gyro_sketch(profile.sketch);
  if (sketch == nullptr || !(profile.text == sketch->columns) || !format.is_known()) return "";
  if (!is_same_scale(format.columns.scale_dps, profile.text.scale_dps))
    return fmt::format("{} prints {} ({:.6g} deg/s a unit), but these lines say {:.6g} deg/s a unit",
                       sketch->name, sketch->prints, profile.text.scale_dps, format.columns.scale_dps);
  if (!read_alike(profile.text, format.columns, format.sample_line))
    return fmt::format("the words on these lines name other columns than {} prints", sketch->name);
  return "";
}

/// Rounding adds an error of a step / sqrt(12), which no average takes away from a gyro at rest.
std::string remark_on_resolution(std::size_t decimals, double scale_dps) {
  const double step_dps = std::pow(10.0, -static_cast<double>(decimals)) * scale_dps;
  if (decimals == 0 || step_dps / std::sqrt(12.0) <= usual_noise_dps) return "";
  return fmt::format(
      "{} decimals are steps of {:.3f} deg/s, coarser than a gyro's noise ({:g} deg/s): print more decimals, "
      "such as Serial.print(rate, 4)",
      decimals, step_dps, usual_noise_dps);
}

/// Of a gyro that sends fewer samples than a camera frames.
static std::string remark_on_few(double rate_hz) {
  if (rate_hz >= usual_frames_hz) return "";
  return fmt::format(
      "a rate of {:g} /s is too low: a frame without a sample is not valid; print 50 samples a second or "
      "more (its delay, its baud rate), and set output_rate_hz in [gyro] of the profile",
      rate_hz);
}

std::string remark_on_rates(const GyroProfile& profile) {
  std::vector<std::string> remarks{remark_on_few(profile.output_rate_hz)};
  if (const GyroSketch* sketch = find_gyro_sketch(profile.sketch)) {
    if (!sketch->remark.empty()) remarks.push_back(fmt::format("{}: {}", sketch->title, sketch->remark));
    if (const std::string resolution = remark_on_resolution(sketch->decimals, sketch->columns.scale_dps);
        !resolution.empty())
      remarks.push_back(fmt::format("{} as published: {}", sketch->title, resolution));
  } else if (const GyroProtocol& protocol = gyro_protocol(profile.protocol); protocol.remark != nullptr) {
    remarks.emplace_back(protocol.remark(profile));
  }
  std::erase(remarks, "");
  return fmt::format("{}", fmt::join(remarks, "; "));
}

}  // namespace thermorig::sensors
