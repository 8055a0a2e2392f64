// SPDX-License-Identifier: MIT
// What is recognised in the layouts that public sketches and loggers print. All values are made up.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <random>

#include "support/gyro_scanners.h"
#include "thermorig/sensors/text_format.h"
#include "wire/scan.h"

namespace thermorig::test::text_layouts {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

constexpr double rad_s = 57.29577951308232;
constexpr std::array<double, 3> gyro_dps{0.9, -0.4, 20.1};  // about which the sensor's noise lies

/// What a sensor measures at one line; noise makes each differ.
struct Values {
  std::array<double, 3> acceleration_g, gyro, field_ut;  // gyro: in the unit of the layout
  int ms;

  double a(std::size_t axis, double unit = 1.0) const { return unit * acceleration_g[axis]; }
  double g(std::size_t axis) const { return gyro[axis]; }
  double m(std::size_t axis) const { return field_ut[axis]; }
};

std::vector<Values> values_in(double scale_dps) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise;
  std::vector<Values> all;
  for (int i = 0; i < 40; ++i) {
    Values values{{0.01, -0.02, 1.0}, {}, {20.0, -12.0, 39.0}, 1000 + 10 * i};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      values.acceleration_g[axis] += 0.004 * noise(random);
      values.gyro[axis] = (gyro_dps[axis] + 0.1 * noise(random)) / scale_dps;
      values.field_ut[axis] += 0.4 * noise(random);
    }
    all.push_back(values);
  }
  return all;
}

struct Layout {
  const char* name;
  std::function<std::string(const Values&)> lines;
  double scale_dps = 1.0;
  std::string above = "";         // lines that come once
  bool asks_for_columns = false;  // nothing says which they are
  bool asks_for_unit = false;
};

std::string text_of(const Layout& layout) {
  std::string text = layout.above;
  for (const Values& values : values_in(layout.scale_dps)) text += layout.lines(values) + "\r\n";
  return text;
}

std::optional<sensors::TextFormat> guess(const std::string& text) {
  const ByteVector bytes(text.begin(), text.end());
  return sensors::guess_text_format(bytes, sensors::StreamStart::at_line_start, 0.4);
}

/// The proposed columns, read by the decoder, give every sample in deg/s.
void expect_rates(const Layout& layout, const sensors::TextFormat& format) {
  TextColumns columns = format.columns;
  if (!format.scale_known) columns.scale_dps = layout.scale_dps;
  const std::string text = text_of(layout);
  const auto scan =
      scan_any_chunking<wire::GyroMessage>(text_scanner(columns, sensors::StreamStart::at_line_start),
                                           ByteVector(text.begin(), text.end()), Stream::ends);
  EXPECT_EQ(scan.messages.size(), 40U);
  EXPECT_EQ(scan.counters.bad_value, 0U);
  std::array<double, 3> sum{};
  for (const auto& message : scan.messages) {
    EXPECT_FALSE(message.lost_before);
    for (std::size_t axis = 0; axis < 3; ++axis) sum[axis] += message.reading.rate_dps[axis];
  }
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (columns.rate[axis] >= 0) {
      EXPECT_NEAR(sum[axis] / 40.0, gyro_dps[axis], 0.2 + 0.005 * layout.scale_dps) << "axis " << axis;
    }
}

std::string counts(double value) {
  return fmt::format("{:.0f}", value);
}

const std::vector<Layout> layouts{
    {"i2cdevlib MPU6050_raw",
     [](const Values& v) {
       return fmt::format("a/g:\t{:.0f}\t{:.0f}\t{:.0f}\t{:.0f}\t{:.0f}\t{:.0f}", v.a(0, 16384),
                          v.a(1, 16384), v.a(2, 16384), v.g(0), v.g(1), v.g(2));
     },
     1.0 / 131.0},
    {"Adafruit MPU6050 basic",
     [](const Values& v) {
       return fmt::format(
           "Acceleration X: {:.2f}, Y: {:.2f}, Z: {:.2f} m/s^2\r\nRotation X: {:.2f}, Y: {:.2f}, "
           "Z: {:.2f} rad/s\r\nTemperature: 28.41 degC\r\n",
           v.a(0, 9.81), v.a(1, 9.81), v.a(2, 9.81), v.g(0), v.g(1), v.g(2));
     },
     rad_s},
    {"Adafruit MPU6050 plotter",
     [](const Values& v) {
       return fmt::format("AccelX:{:.2f},AccelY:{:.2f},AccelZ:{:.2f}, GyroX:{:.2f},GyroY:{:.2f},GyroZ:{:.2f}",
                          v.a(0, 9.81), v.a(1, 9.81), v.a(2, 9.81), v.g(0), v.g(1), v.g(2));
     },
     rad_s},
    {"Adafruit LSM6DS",
     [](const Values& v) {
       return fmt::format(
           "\t\tTemperature 25.10 deg C\r\n\t\tAccel X: {:.2f} \tY: {:.2f} \tZ: {:.2f} m/s^2 \r\n"
           "\t\tGyro X: {:.2f} \tY: {:.2f} \tZ: {:.2f} radians/s \r\n",
           v.a(0, 9.81), v.a(1, 9.81), v.a(2, 9.81), v.g(0), v.g(1), v.g(2));
     },
     rad_s},
    {"Adafruit unified, plotter form",
     [](const Values& v) {
       return fmt::format("25.10,{:.2f},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f}", v.a(0, 9.81), v.a(1, 9.81),
                          v.a(2, 9.81), v.g(0), v.g(1), v.g(2));
     },
     rad_s, "", true, true},
    {"Adafruit BNO055 read_all_data",
     [](const Values& v) {
       return fmt::format(
           "Orient:\tx= 359.94 |\ty= -1.56 |\tz= 2.31\r\nGyro:\tx= {:.2f} |\ty= {:.2f} |\tz= {:.2f}"
           "\r\nLinear:\tx= 0.01 |\ty= 0.02 |\tz= -0.03\r\nGravity:\tx= {:.2f} |\ty= 0.12 |\tz= 9.80"
           "\r\n\r\ntemperature: 28\r\nCalibration: Sys=0 Gyro=3 Accel=0 Mag=0\r\n--",
           v.g(0), v.g(1), v.g(2), v.a(0, 9.81));
     },
     rad_s},
    {"Adafruit BNO08x more_reports",
     [](const Values& v) {
       return fmt::format(
           "Accelerometer - x: {:.2f} y: {:.2f} z: {:.2f}\r\nGyro - x: {:.2f} y: {:.2f} z: {:.2f}\r\n"
           "Rotation Vector - r: 0.99 i: 0.01 j: 0.02 k: 0.03",
           v.a(0, 9.81), v.a(1, 9.81), v.a(2, 9.81), v.g(0), v.g(1), v.g(2));
     },
     rad_s},
    {"SparkFun BNO080 Example3",
     [](const Values& v) { return fmt::format("{:.2f},{:.2f},{:.2f},", v.g(0), v.g(1), v.g(2)); }, rad_s,
     "BNO080 Read Example\r\nGyro enabled\r\nOutput in form x, y, z, in radians per second\r\n"},
    {"Arduino SimpleGyroscope",
     [](const Values& v) { return fmt::format("{:.2f}\t{:.2f}\t{:.2f}", v.g(0), v.g(1), v.g(2)); }, 1.0,
     "Gyroscope sample rate = 104.00 Hz\r\n\r\nGyroscope in degrees/second\r\nX\tY\tZ\r\n"},
    {"SparkFun ICM-20948 Example1",
     [](const Values& v) {
       return fmt::format(
           "Scaled. Acc (mg) [ {:09.2f}, {:09.2f}, {:09.2f} ], Gyr (DPS) [ {:09.2f}, {:09.2f}, "
           "{:09.2f} ], Mag (uT) [ {:09.2f}, {:09.2f}, {:09.2f} ], Tmp (C) [  00025.10 ]",
           v.a(0, 1000), v.a(1, 1000), v.a(2, 1000), v.g(0), v.g(1), v.g(2), v.m(0), v.m(1), v.m(2));
     }},
    {"SparkFun ICM-20948 raw",
     [](const Values& v) {
       return fmt::format(
           "RAW. Acc [ {:06.0f}, {:06.0f}, {:06.0f} ], Gyr [ {:06.0f}, {:06.0f}, {:06.0f} ], Mag [ "
           "00123, -00045, 00310 ], Tmp [ 01234 ]",
           v.a(0, 16384), v.a(1, 16384), v.a(2, 16384), v.g(0), v.g(1), v.g(2));
     },
     1.0 / 131.0},
    {"SparkFun BMI270 Example1",
     [](const Values& v) {
       return fmt::format(
           "Acceleration in g's\tX: {:.3f}\tY: {:.3f}\tZ: {:.3f}\tRotation in deg/sec\tX: {:.3f}\tY: "
           "{:.3f}\tZ: {:.3f}",
           v.a(0), v.a(1), v.a(2), v.g(0), v.g(1), v.g(2));
     }},
    {"tockn MPU6050",
     [](const Values& v) {
       return fmt::format(
           "temp : 26.03\r\naccX : {:.2f}\taccY : {:.2f}\taccZ : {:.2f}\r\ngyroX : {:.2f}\tgyroY : "
           "{:.2f}\tgyroZ : {:.2f}\r\naccAngleX : 1.16\taccAngleY : 2.19\r\ngyroAngleX : 41.00\t"
           "gyroAngleY : 11.95\tgyroAngleZ : {:.2f}\r\nangleX : 0.94\tangleY : 2.16\tangleZ : 92.90\r\n"
           "=======================================================",
           v.a(0), v.a(1), v.a(2), v.g(0), v.g(1), v.g(2), 0.02 * v.ms);
     }},
    {"rfetick MPU6050_light",
     [](const Values& v) {
       return fmt::format(
           "TEMPERATURE: 26.03\r\nACCELERO  X: {:.2f}\tY: {:.2f}\tZ: {:.2f}\r\nGYRO      X: {:.2f}\tY: "
           "{:.2f}\tZ: {:.2f}\r\nACC ANGLE X: 1.16\tY: 2.19\r\nANGLE     X: 0.94\tY: 2.16\tZ: 92.90",
           v.a(0), v.a(1), v.a(2), v.g(0), v.g(1), v.g(2));
     }},
    {"Bolder Flight invensense-imu",
     [](const Values& v) {
       return fmt::format(
           "1\t0\t{:.2f}\t{:.2f}\t{:.2f}\t{:.2f}\t{:.2f}\t{:.2f}\t{:.1f}\t{:.1f}\t{:.1f}\t25.1", v.a(0, 9.81),
           v.a(1, 9.81), v.a(2, 9.81), v.g(0), v.g(1), v.g(2), v.m(0), v.m(1), v.m(2));
     },
     rad_s, "", true, true},
    {"SparkFun 9DoF Razor M0",
     [](const Values& v) {
       return fmt::format("{}, {:.2f}, {:.2f}, {:.2f}, {:.2f}, {:.2f}, {:.2f}, {:.2f}, {:.2f}, {:.2f}", v.ms,
                          v.a(0), v.a(1), v.a(2), v.g(0), v.g(1), v.g(2), v.m(0), v.m(1), v.m(2));
     },
     1.0, "", true, true},
    {"Razor AHRS",
     [](const Values& v) {
       return fmt::format("#A-C={:.2f},{:.2f},{:.2f}\r\n#M-C=12.00,31.00,288.00\r\n#G-C={:.2f},{:.2f},{:.2f}",
                          v.a(0, 256), v.a(1, 256), v.a(2, 256), v.g(0), v.g(1), v.g(2));
     },
     1.0 / 14.375},

    {"an Arduino IDE's clock in front of several lines",
     [](const Values& v) {
       return fmt::format(
           "12:34:{:06.3f} -> Acc X: {:.2f}, Y: {:.2f}, Z: {:.2f}\n12:34:{:06.3f} -> Gyro X: {:.2f}, Y: "
           "{:.2f}, Z: {:.2f} deg/s",
           0.001 * v.ms, v.a(0), v.a(1), v.a(2), 0.001 * v.ms, v.g(0), v.g(1), v.g(2));
     }},
    {"a date and a clock in two columns, named by a header",
     [](const Values& v) {
       return fmt::format("12/06/2020,12:15:{:05.2f},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f},27.10,",
                          0.001 * v.ms, v.a(0, 1000), v.a(1, 1000), v.a(2, 1000), v.g(0), v.g(1), v.g(2));
     },
     1.0, "rtcDate,rtcTime,aX,aY,aZ,gX,gY,gZ,imu_degC,\r\n"},
    {"a wide table between tabs whose clock holds a blank",
     [](const Values& v) {
       std::string line = fmt::format(
           "0x50\t 06:00:{0:06.3f}\t 2025-01-01 06:00:{0:06.3f}\t{1:.4f}\t{2:.4f}\t{3:.4f}\t"
           "{4:.4f}\t{5:.4f}\t{6:.4f}",
           0.001 * v.ms, v.a(0), v.a(1), v.a(2), v.g(0), v.g(1), v.g(2));
       for (int i = 0; i < 32; ++i) line += "\t101447.25";
       return line;
     },
     1.0,
     [] {
       std::string header =
           "StartTime: 2025-01-01 "
           "06:00:00.000\r\naddress\tTime(s)\tChipTime\tax(g)\tay(g)\taz(g)\twx(deg/s)\t"
           "wy(deg/s)\twz(deg/s)";
       for (int i = 0; i < 32; ++i) header += fmt::format("\tD{}(Pa)", i);
       return header + "\r\n";
     }()},
    {"degree signs in UTF-8",
     [](const Values& v) {
       return fmt::format("Gyro X: {:.2f} \xC2\xB0/s  Y: {:.2f} \xC2\xB0/s  Z: {:.2f} \xC2\xB0/s", v.g(0),
                          v.g(1), v.g(2));
     }},
    {"degree signs in Latin-1, right behind the numbers",
     [](const Values& v) {
       return fmt::format("gx={:.2f}\xB0/s gy={:.2f}\xB0/s gz={:.2f}\xB0/s", v.g(0), v.g(1), v.g(2));
     }},
    {"colours",
     [](const Values& v) {
       return fmt::format("\x1b[32mgyro\x1b[0m {:.2f} {:.2f} {:.2f} \x1b[1;31mdps\x1b[0m", v.g(0), v.g(1),
                          v.g(2));
     }},
    {"a byte order mark in front",
     [](const Values& v) { return fmt::format("{},{:.2f},{:.2f},{:.2f}", v.ms, v.g(0), v.g(1), v.g(2)); },
     1.0, "\xEF\xBB\xBFms,gx_dps,gy_dps,gz_dps\r\n"},
    {"JSON, a name each",
     [](const Values& v) {
       return fmt::format(
           R"({{"t":{},"ax":{:.2f},"ay":{:.2f},"az":{:.2f},"gx":{:.3f},"gy":{:.3f},"gz":{:.3f}}})", v.ms,
           v.a(0, 9.81), v.a(1, 9.81), v.a(2, 9.81), v.g(0), v.g(1), v.g(2));
     },
     1.0, "", false, true},
    {"JSON with blanks and the unit in the names",
     [](const Values& v) {
       return fmt::format(
           R"({{"gyro_x_dps": {:.3f}, "gyro_y_dps": {:.3f}, "gyro_z_dps": {:.3f}, "temp": 25.1}})", v.g(0),
           v.g(1), v.g(2));
     }},
    {"JSON, nested",
     [](const Values& v) {
       return fmt::format(
           R"({{"acc":{{"x":{:.2f},"y":{:.2f},"z":{:.2f}}},"gyro":{{"x":{:.3f},"y":{:.3f},"z":{:.3f}}},"ms":{}}})",
           v.a(0), v.a(1), v.a(2), v.g(0), v.g(1), v.g(2), v.ms);
     },
     1.0, "", false, true},
    {"JSON, arrays",
     [](const Values& v) {
       return fmt::format(
           R"({{"accel":[{:.2f},{:.2f},{:.2f}],"gyro_rad_s":[{:.4f}, {:.4f}, {:.4f}],"t_ms":{}}})", v.a(0),
           v.a(1), v.a(2), v.g(0), v.g(1), v.g(2), v.ms);
     },
     rad_s},
    {"a check sum at the end",
     [](const Values& v) {
       return fmt::format("$GYRO,{:.3f},{:.3f},{:.3f}*{:02X}", v.g(0), v.g(1), v.g(2), v.ms % 256);
     },
     1.0, "", false, true},
    {"raw counts by name",
     [](const Values& v) {
       return "AcX = " + counts(v.a(0, 16384)) + " | AcY = " + counts(v.a(1, 16384)) +
              " | AcZ = " + counts(v.a(2, 16384)) + " | Tmp = 26.85 | GyX = " + counts(v.g(0)) +
              " | GyY = " + counts(v.g(1)) + " | GyZ = " + counts(v.g(2));
     },
     1.0 / 65.5, "", false, true},
    {"one axis a line",
     [](const Values& v) {
       return fmt::format(
           "accelX: {:.2f}\naccelY: {:.2f}\naccelZ: {:.2f}\ngyroX: {:.3f} dps\ngyroY: {:.3f} dps\ngyroZ: "
           "{:.3f} dps",
           v.a(0), v.a(1), v.a(2), v.g(0), v.g(1), v.g(2));
     }},
    {"milli-units and another order of axes",
     [](const Values& v) {
       return fmt::format("omega_z:{:.0f} omega_x:{:.0f} omega_y:{:.0f} mdps", v.g(2), v.g(0), v.g(1));
     },
     1e-3},
    {"angles beside rates",
     [](const Values& v) {
       return fmt::format(
           "Yaw: {:.1f} Pitch: 2.0 Roll: -1.0 AngVelX: {:.2f} AngVelY: {:.2f} AngVelZ: {:.2f} deg/s",
           0.01 * v.ms, v.g(0), v.g(1), v.g(2));
     }},
    {"two kinds of lines whose columns alone have names",
     [](const Values& v) {
       return fmt::format("ax:{:.2f},ay:{:.2f},az:{:.2f}\ngx:{:.2f},gy:{:.2f},gz:{:.2f} deg/s", v.a(0),
                          v.a(1), v.a(2), v.g(0), v.g(1), v.g(2));
     }},
    {"letters before three numbers each",
     [](const Values& v) {
       return fmt::format("A: {:6.0f} {:6.0f} {:6.0f}    G: {:6.0f} {:6.0f} {:6.0f}", v.a(0, 16384),
                          v.a(1, 16384), v.a(2, 16384), v.g(0), v.g(1), v.g(2));
     },
     0.00875, "", false, true},
    {"a line each of a letter, with units behind",
     [](const Values& v) {
       return fmt::format(
           "G: {:.2f}, {:.2f}, {:.2f} deg/s\nA: {:.2f}, {:.2f}, {:.2f} g\nM: 0.12, 0.34, 0.56 gauss\n",
           v.g(0), v.g(1), v.g(2), v.a(0), v.a(1), v.a(2));
     }},
    {"a quoted header with units",
     [](const Values& v) {
       return fmt::format("{:.3f},{:.4E},{:.4E},{:.4E},0.35", 0.001 * v.ms, v.g(0), v.g(1), v.g(2));
     },
     rad_s,
     "\"Time (s)\",\"Gyroscope x (rad/s)\",\"Gyroscope y (rad/s)\",\"Gyroscope z (rad/s)\",\"Absolute "
     "(rad/s)\"\r\n"},
    {"a header that names axes in another order",
     [](const Values& v) { return fmt::format("{},{:.3f},{:.3f},{:.3f}", v.ms, v.g(2), v.g(1), v.g(0)); },
     1.0, "seconds_elapsed,z,y,x\r\n", true, true},
    {"Adafruit's words with another sketch's units",
     [](const Values& v) {
       return fmt::format("AccelX:{:.2f},AccelY:{:.2f},AccelZ:{:.2f}, GyroX:{:.2f},GyroY:{:.2f},GyroZ:{:.2f}",
                          v.a(0), v.a(1), v.a(2), v.g(0), v.g(1), v.g(2));
     },
     1.0, "", false, true},
    {"degrees that may be an angle",
     [](const Values& v) {
       return fmt::format("gyro_x_deg:{:.2f} gyro_y_deg:{:.2f} gyro_z_deg:{:.2f}", v.g(0), v.g(1), v.g(2));
     },
     1.0, "", false, true},
    {"another device's unit at the end of the line",
     [](const Values& v) {
       return fmt::format("gx={:.4f} gy={:.4f} gz={:.4f} servo=-0.2 deg/s", v.g(0), v.g(1), v.g(2));
     },
     rad_s, "", false, true},
    {"a range in front",
     [](const Values& v) {
       return fmt::format("range:500dps,gx:{:.0f},gy:{:.0f},gz:{:.0f}", v.g(0), v.g(1), v.g(2));
     },
     1.0 / 65.5, "", false, true},
    {"JSON, the unit of another object",
     [](const Values& v) {
       return fmt::format(R"({{"gyro":[{:.4f},{:.4f},{:.4f}],"wheel":{{"speed":-0.2,"unit":"deg/s"}}}})",
                          v.g(0), v.g(1), v.g(2));
     },
     rad_s, "", false, true},
    {"JSON, the unit of its own object",
     [](const Values& v) {
       return fmt::format(
           R"({{"gyro":{{"x":{:.4f},"y":{:.4f},"z":{:.4f},"unit":"rad/s"}},"wheel":{{"speed":-0.2,"unit":"deg/s"}}}})",
           v.g(0), v.g(1), v.g(2));
     },
     rad_s},
    {"JSON, an object of units",
     [](const Values& v) {
       return fmt::format(R"({{"gyro":[{:.4f},{:.4f},{:.4f}],"units":{{"acc":"g","gyro":"rad/s"}}}})", v.g(0),
                          v.g(1), v.g(2));
     },
     rad_s},
    {"JSON, the full scale beside the counts",
     [](const Values& v) {
       return fmt::format(R"({{"fs_dps":250,"gx":{:.0f},"gy":{:.0f},"gz":{:.0f}}})", v.g(0), v.g(1), v.g(2));
     },
     1.0 / 131.0, "", false, true},
    {"JSON, what is asked for beside what is measured",
     [](const Values& v) {
       return fmt::format(
           R"({{"target":{{"gx":0.0,"gy":0.0,"gz":20.0}},"actual":{{"gx":{:.2f},"gy":{:.2f},"gz":{:.2f}}}}})",
           v.g(0), v.g(1), v.g(2));
     },
     1.0, "", false, true},
    {"a maximum before three bare numbers",
     [](const Values& v) {
       return fmt::format("gyro max 250 deg/s: {:.0f} {:.0f} {:.0f}", v.g(0), v.g(1), v.g(2));
     },
     1.0 / 131.0, "", true, true},
    {"a wish before the rates",
     [](const Values& v) {
       return fmt::format("target rate: 60 deg/s gyro: {:.4f} {:.4f} {:.4f}", v.g(0), v.g(1), v.g(2));
     },
     rad_s, "", false, true},
    {"noise behind the rates",
     [](const Values& v) {
       return fmt::format("gyro: {:.4f} {:.4f} {:.4f} gyro noise: 0.05 dps", v.g(0), v.g(1), v.g(2));
     },
     rad_s, "", false, true},
    {"a range in a banner above bare numbers",
     [](const Values& v) { return fmt::format("{:.4f},{:.4f},{:.4f}", v.g(0), v.g(1), v.g(2)); }, rad_s,
     "Gyro range set to: +- 500 deg/s\r\nFilter bandwidth set to: 5 Hz\r\n", false, true},
    {"a factor in front of the unit",
     [](const Values& v) {
       return fmt::format("gx (0.1 dps): {:.0f} gy (0.1 dps): {:.0f} gz (0.1 dps): {:.0f}", v.g(0), v.g(1),
                          v.g(2));
     },
     0.1, "", false, true},
    {"a factor within words",
     [](const Values& v) {
       return fmt::format("gyro (in 0.1 deg/s): {:.0f},{:.0f},{:.0f}", v.g(0), v.g(1), v.g(2));
     },
     0.1, "", false, true},
    {"a unit that is another number's name",
     [](const Values& v) {
       return fmt::format("gx: {:.4f} gy: {:.4f} gz: {:.4f} rpm: 3", v.g(0), v.g(1), v.g(2));
     },
     rad_s, "", false, true},
    {"ten times",
     [](const Values& v) {
       return fmt::format("gyro x10 dps: {:.0f} {:.0f} {:.0f}", v.g(0), v.g(1), v.g(2));
     },
     0.1, "", false, true},
    {"a factor behind the unit",
     [](const Values& v) {
       return fmt::format("gyro (deg/s*10): {:.0f} {:.0f} {:.0f}", v.g(0), v.g(1), v.g(2));
     },
     0.1, "", false, true},
    {"a factor at the name",
     [](const Values& v) {
       return fmt::format("gx*1000 (rad/s): {:.0f} gy*1000 (rad/s): {:.0f} gz*1000 (rad/s): {:.0f}", v.g(0),
                          v.g(1), v.g(2));
     },
     0.001 * rad_s, "", false, true},
    {"a power of ten in a header",
     [](const Values& v) { return fmt::format("{},{:.0f},{:.0f},{:.0f}", v.ms, v.g(0), v.g(1), v.g(2)); },
     0.001 * rad_s, "ms,gx(1e-3rad/s),gy(1e-3rad/s),gz(1e-3rad/s)\r\n", false, true},
    {"counts a unit",
     [](const Values& v) {
       return fmt::format("gyro (131 LSB/dps): {:.0f} {:.0f} {:.0f}", v.g(0), v.g(1), v.g(2));
     },
     1.0 / 131.0, "", false, true},
    {"axes in another order, named at once",
     [](const Values& v) {
       return fmt::format("gyro (z,y,x) dps: {:.2f} {:.2f} {:.2f}", v.g(2), v.g(1), v.g(0));
     }},
    {"a number of the line that is no clock",
     [](const Values& v) {
       return fmt::format("seq:{} gx:{:.2f} gy:{:.2f} gz:{:.2f} dps", v.ms / 10, v.g(0), v.g(1), v.g(2));
     }},
    {"an angle that rises, in a column of a header",
     [](const Values& v) { return fmt::format("{},{:.2f},{:.2f},{:.2f}", v.ms, v.g(0), v.g(1), v.g(2)); },
     1.0, "odometer,gx_dps,gy_dps,gz_dps\r\n"},
    {"a header of two kinds with their units behind",
     [](const Values& v) {
       return fmt::format("{:.2f},{:.2f},{:.2f},{:.3f},{:.3f},{:.3f}", v.g(2), v.g(1), v.g(0), v.a(2), v.a(1),
                          v.a(0));
     },
     1.0, "gz,gy,gx,az,ay,ax [dps,g]\r\n"},
    {"a row of units below the names",
     [](const Values& v) {
       return fmt::format("{:.4f};{:.4f};{:.4f};{:.3f};{:.3f};{:.3f}", v.g(0), v.g(1), v.g(2), v.a(0), v.a(1),
                          v.a(2));
     },
     rad_s, "gx;gy;gz;ax;ay;az\r\n[rad/s];[rad/s];[rad/s];[g];[g];[g]\r\n"},
    {"hundredths",
     [](const Values& v) {
       return fmt::format("gx:{:.0f} gy:{:.0f} gz:{:.0f} cdps", v.g(0), v.g(1), v.g(2));
     },
     0.01},
    {"revolutions a minute",
     [](const Values& v) {
       return fmt::format("gyro rpm x={:.4f} y={:.4f} z={:.4f}", v.g(0), v.g(1), v.g(2));
     },
     6.0},
    {"degrees a minute",
     [](const Values& v) {
       return fmt::format("gyro [deg/min] {:.1f} {:.1f} {:.1f}", v.g(0), v.g(1), v.g(2));
     },
     1.0 / 60.0},
    {"roll, pitch and yaw of a gyro",
     [](const Values& v) {
       return fmt::format("gyro(deg/s) roll={:.2f} pitch={:.2f} yaw={:.2f}", v.g(0), v.g(1), v.g(2));
     }},
    {"another column's unit in a header",
     [](const Values& v) {
       return fmt::format("{},{:.4f},{:.4f},{:.4f},100.0", v.ms, v.g(0), v.g(1), v.g(2));
     },
     rad_s, "ms,gx,gy,gz,servo [deg/s]\r\n", false, true},
    {"a list of units, one a column",
     [](const Values& v) { return fmt::format("{:.4f},{:.4f},{:.4f},100.0", v.g(0), v.g(1), v.g(2)); }, rad_s,
     "gx,gy,gz,servo [rad/s,rad/s,rad/s,deg/s]\r\n"},
    {"tenths in words",
     [](const Values& v) {
       return fmt::format("gyro in tenths of deg/s: {:.0f} {:.0f} {:.0f}", v.g(0), v.g(1), v.g(2));
     },
     0.1, "", false, true},
    {"yaw first",
     [](const Values& v) {
       return fmt::format("YPR rates (deg/s): {:.2f}, {:.2f}, {:.2f}", v.g(2), v.g(1), v.g(0));
     }},
    {"indexes for axes",
     [](const Values& v) {
       return fmt::format("gyro[2]={:.2f} gyro[1]={:.2f} gyro[0]={:.2f} dps", v.g(2), v.g(1), v.g(0));
     }},
    {"a set point beside what is measured",
     [](const Values& v) {
       return fmt::format("gx_des:50 gy_des:50 gz_des:50 gx:{:.2f} gy:{:.2f} gz:{:.2f} dps", v.g(0), v.g(1),
                          v.g(2));
     }},
    {"a clock in nanoseconds",
     [](const Values& v) {
       return fmt::format("{}000000,{:.2f},{:.2f},{:.2f}", 1600000000000LL + v.ms, v.g(0), v.g(1), v.g(2));
     },
     1.0, "timestamp_ns,gx_dps,gy_dps,gz_dps\r\n"},
    {"a range in brackets behind the counts",
     [](const Values& v) {
       return fmt::format("GyX:{:.0f} GyY:{:.0f} GyZ:{:.0f} (500 dps full scale)", v.g(0), v.g(1), v.g(2));
     },
     1.0 / 65.5, "", false, true},
    {"a range at the name",
     [](const Values& v) { return fmt::format("gyro500dps {:.0f} {:.0f} {:.0f}", v.g(0), v.g(1), v.g(2)); },
     1.0 / 65.5, "", false, true},
    {"a range among the numbers",
     [](const Values& v) { return fmt::format("Gyro 500dps {:.0f} {:.0f} {:.0f}", v.g(0), v.g(1), v.g(2)); },
     1.0 / 65.5, "", true, true},
    {"a range behind the unit",
     [](const Values& v) {
       return fmt::format("L3GD20 gyro {:.2f} {:.2f} {:.2f} dps (250)", v.g(0), v.g(1), v.g(2));
     }},
    {"units that are not the same on each axis",
     [](const Values& v) {
       return fmt::format("gx:{:.4f} rad/s gy:{:.4f} rad/s gz:{:.4f} deg/s", v.g(0), v.g(1), v.g(2));
     },
     rad_s, "", false, true},
    {"a word that nobody knows before axes and a unit",
     [](const Values& v) {
       return fmt::format("MPU6050 x:{:.4f} y:{:.4f} z:{:.4f} rad/s", v.g(0), v.g(1), v.g(2));
     },
     rad_s},
    {"bare columns of three",
     [](const Values& v) { return fmt::format("{:.2f} {:.2f} {:.2f}", v.g(0), v.g(1), v.g(2)); }, 1.0, "",
     true, true},
    {"units as s^-1 in a header",
     [](const Values& v) { return fmt::format("{},{:.6f},{:.6f},{:.6f}", v.ms, v.g(0), v.g(1), v.g(2)); },
     rad_s, "#timestamp [ms],wx [rad s^-1],wy [rad s^-1],wz [rad s^-1]\r\n"},
    {"degrees per hour",
     [](const Values& v) { return fmt::format("gyro {:.0f} {:.0f} {:.0f} deg/h", v.g(0), v.g(1), v.g(2)); },
     1.0 / 3600.0},
    {"Teleplot, an axis a line",
     [](const Values& v) {
       return fmt::format(">gx:{:.3f}\r\n>gy:{:.3f}\r\n>gz:{:.3f}", v.g(0), v.g(1), v.g(2));
     },
     1.0, "", false, true},
    {"the end of a C string in front",
     [](const Values& v) {
       return std::string(1, '\0') + fmt::format("gx:{:.3f} gy:{:.3f} gz:{:.3f} dps", v.g(0), v.g(1), v.g(2));
     }},
};

TEST(TextLayouts, AreReadByTheirWordsOrAskedFor) {
  for (const Layout& layout : layouts) {
    SCOPED_TRACE(layout.name);
    const auto format = guess(text_of(layout));
    ASSERT_TRUE(format.has_value());
    SCOPED_TRACE(fmt::format("prefix \"{}\", columns {},{},{}, {} deg/s: {}", format->columns.prefix,
                             format->columns.rate[0], format->columns.rate[1], format->columns.rate[2],
                             format->columns.scale_dps, fmt::join(format->assumptions, "; ")));
    EXPECT_EQ(format->refusal, "");
    EXPECT_EQ(format->rates_known, !layout.asks_for_columns);
    EXPECT_EQ(format->scale_known, !layout.asks_for_unit);
    EXPECT_EQ(sensors::open_question(*format).empty(), format->is_known());
    if (format->scale_known) {
      EXPECT_NEAR(format->columns.scale_dps / layout.scale_dps, 1.0, 1e-6);
    }
    expect_rates(layout, *format);
  }
}

TEST(TextLayouts, AreNamedAfterTheirSketchWhereTheirWordsShowIt) {
  const std::map<std::string, std::string> names{{"i2cdevlib MPU6050_raw", "i2cdevlib-mpu6050"},
                                                 {"Adafruit MPU6050 basic", "adafruit-mpu6050"},
                                                 {"Adafruit MPU6050 plotter", "adafruit-mpu6050-plotter"},
                                                 {"Adafruit LSM6DS", "adafruit-lsm6ds"},
                                                 {"Adafruit BNO055 read_all_data", "adafruit-bno055"},
                                                 {"Adafruit BNO08x more_reports", "adafruit-bno08x"},
                                                 {"SparkFun BNO080 Example3", "sparkfun-bno080"},
                                                 {"Arduino SimpleGyroscope", "arduino-imu"},
                                                 {"SparkFun ICM-20948 Example1", "sparkfun-icm20948"},
                                                 {"SparkFun ICM-20948 raw", "sparkfun-icm20948-raw"},
                                                 {"SparkFun BMI270 Example1", "sparkfun-bmi270"},
                                                 {"tockn MPU6050", "tockn-mpu6050"},
                                                 {"rfetick MPU6050_light", "mpu6050-light"},
                                                 {"Razor AHRS", "razor-ahrs"}};
  std::size_t named = 0;
  for (const Layout& layout : layouts) {
    const auto name = names.find(layout.name);
    named += name != names.end() ? 1U : 0U;
    EXPECT_EQ(guess(text_of(layout))->sketch, name == names.end() ? "" : name->second) << layout.name;
  }
  EXPECT_EQ(named, names.size());
}

TEST(TextLayouts, OfOneAxisALineAreReadForZAndTheOthersAreNamed) {
  const auto format = guess(text_of(*std::find_if(layouts.begin(), layouts.end(), [](const Layout& layout) {
    return layout.name == std::string("one axis a line");
  })));
  ASSERT_TRUE(format.has_value());
  EXPECT_EQ(format->columns.prefix, "gyroZ:");
  EXPECT_EQ(format->columns.rate, (std::array<int, 3>{-1, -1, 0}));
  EXPECT_THAT(format->assumptions, Contains(AllOf(HasSubstr("\"gyroX:\""), HasSubstr("\"gyroY:\""))));
}

}  // namespace
}  // namespace thermorig::test::text_layouts
