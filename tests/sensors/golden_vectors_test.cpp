// SPDX-License-Identifier: MIT
// Golden vectors of protocols/vectors: text_camera.txt, binary_camera.txt, i2c_stick.txt, mlx_raw.txt, and
// those of the gyros.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "support/gyro_scanners.h"
#include "thermorig/sensors/camera_protocol.h"
#include "thermorig/sensors/device_stream.h"
#include "wire/scan.h"
#include "wire/vector_fields.h"

namespace thermorig::test {
namespace {

/// What the vector says about the last reading.
void expect_reading(const GyroReading& reading, const Fields& fields) {
  if (fields.contains("counts")) {
    const auto counts = numbers_in(fields.at("counts"));
    for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_EQ(reading.counts[axis], counts.at(axis));
  }
  if (fields.contains("rate_dps")) {
    const auto rates_dps = numbers_in(fields.at("rate_dps"));
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_EQ(reading.rate_dps[axis], static_cast<float>(rates_dps.at(axis)));
  }
  EXPECT_EQ(reading.saturated, count_in(fields, "saturated") == 1);
  EXPECT_EQ(reading.device_time_us.has_value(), fields.contains("time_us"));
  if (fields.contains("time_us")) {
    EXPECT_EQ(reading.device_time_us, std::stoll(fields.at("time_us")));
  }
}

void expect_images(const char* file, const char* protocol) {
  CameraProfile profile;
  profile.protocol = protocol;
  for (const GoldenVector& vector : read_vectors(file)) {
    SCOPED_TRACE(vector.name);
    const Fields fields = fields_in(vector);
    const auto scan =
        scan_any_chunking<wire::CameraMessage>(sensors::camera_scanner(profile), vector.bytes, Stream::ends);
    expect_counters(scan.counters, fields, "frames");
    ASSERT_EQ(scan.messages.size(), count_in(fields, "frames"));
    if (scan.messages.empty()) continue;
    const ThermalFrame& frame = scan.messages.back().frame;
    EXPECT_EQ(std::isfinite(frame.sensor_temp_c), fields.contains("ta_cdeg"));
    if (fields.contains("ta_cdeg")) {
      EXPECT_NEAR(frame.sensor_temp_c, std::stof(fields.at("ta_cdeg")) / 100.0F, 1e-4);
    }
    const std::string pixel = "temp_cdeg_";
    for (const auto& [name, value] : fields)
      if (name.starts_with(pixel)) {
        EXPECT_NEAR(frame.temp_c.at(std::stoul(name.substr(pixel.size()))), std::stof(value) / 100.0F, 1e-4);
      }
  }
}

TEST(GoldenVectors, ImagesAsTextAreReadAsDescribed) {
  expect_images("text_camera.txt", "text");
}

TEST(GoldenVectors, ImagesInBytesAreReadAsDescribed) {
  expect_images("binary_camera.txt", "binary");
}

TEST(GoldenVectors, RawHalfFramesAreReadAsDescribed) {
  expect_images("i2c_stick.txt", "i2c-stick");
  expect_images("mlx_raw.txt", "mlx-raw");
}

TEST(GoldenVectors, WitmotionStreamsAreReadAsDescribed) {
  for (const GoldenVector& vector : read_vectors("witmotion.txt")) {
    SCOPED_TRACE(vector.name);
    const Fields fields = fields_in(vector);
    const auto scan = scan_any_chunking<wire::GyroMessage>(witmotion_scanner(), vector.bytes, Stream::ends);
    expect_counters(scan.counters, fields, "readings");
    ASSERT_EQ(scan.messages.size(), count_in(fields, "readings"));
    if (scan.messages.empty()) continue;
    const GyroReading& reading = scan.messages.back().reading;
    expect_reading(reading, fields);
    EXPECT_EQ(reading.temp_c, std::stof(fields.at("temp_cdeg")) / 100.0F);
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_EQ(reading.rate_dps[axis], static_cast<float>(reading.counts[axis] * 2000.0 / 32768.0));
  }
}

TextColumns columns_in(const Fields& fields) {
  TextColumns columns;
  if (fields.contains("prefix")) columns.prefix = fields.at("prefix");
  if (fields.contains("scale_dps")) columns.scale_dps = std::stod(fields.at("scale_dps"));
  if (fields.contains("time")) columns.time = std::stoi(fields.at("time"));
  if (fields.contains("time_unit_s")) columns.time_unit_s = std::stod(fields.at("time_unit_s"));
  if (fields.contains("rate")) {
    const auto rate = numbers_in(fields.at("rate"));
    for (std::size_t axis = 0; axis < 3; ++axis) columns.rate[axis] = static_cast<int>(rate.at(axis));
  }
  return columns;
}

TEST(GoldenVectors, TextStreamsAreReadAsDescribed) {
  for (const GoldenVector& vector : read_vectors("text_gyro.txt")) {
    SCOPED_TRACE(vector.name);
    const Fields fields = fields_in(vector);
    const sensors::GyroScanner scanner = text_scanner(columns_in(fields));
    const auto scan = scan_any_chunking<wire::GyroMessage>(scanner, vector.bytes, Stream::ends);
    expect_counters(scan.counters, fields, "readings");
    ASSERT_EQ(scan.messages.size(), count_in(fields, "readings"));
    if (!scan.messages.empty()) expect_reading(scan.messages.back().reading, fields);
  }
}

/// `rate_hz`: the profile's.
void expect_samples(const char* file, const char* protocol, double rate_hz = 200.0) {
  for (const GoldenVector& vector : read_vectors(file)) {
    SCOPED_TRACE(vector.name);
    const Fields fields = fields_in(vector);
    GyroProfile profile{.protocol = protocol, .output_rate_hz = rate_hz};
    for (const sensors::GyroSetting& setting : sensors::gyro_protocol(protocol).settings)
      if (fields.contains(setting.name)) profile.settings[setting.name] = std::stod(fields.at(setting.name));
    const auto scan =
        scan_any_chunking<wire::GyroMessage>(sensors::gyro_scanner(profile), vector.bytes, Stream::ends);
    expect_counters(scan.counters, fields, "readings");
    EXPECT_EQ(scan.counters.lost, count_in(fields, "lost"));
    ASSERT_EQ(scan.messages.size(), count_in(fields, "readings"));
    if (scan.messages.empty()) continue;
    const GyroReading& reading = scan.messages.back().reading;
    expect_reading(reading, fields);
    EXPECT_EQ(reading.temp_c.has_value(), fields.contains("temp_cdeg"));
    if (reading.temp_c) {
      EXPECT_FLOAT_EQ(*reading.temp_c, std::stof(fields.at("temp_cdeg")) / 100.0F);
    }
  }
}

TEST(GoldenVectors, MavlinkStreamsAreReadAsDescribed) {
  expect_samples("mavlink_gyro.txt", "mavlink");
}

TEST(GoldenVectors, VectornavStreamsAreReadAsDescribed) {
  expect_samples("vectornav.txt", "vectornav");
}

TEST(GoldenVectors, XsensStreamsAreReadAsDescribed) {
  expect_samples("xsens.txt", "xsens", 100.0);
}

TEST(GoldenVectors, HipnucStreamsAreReadAsDescribed) {
  expect_samples("hipnuc.txt", "hipnuc");
}

TEST(GoldenVectors, MipStreamsAreReadAsDescribed) {
  expect_samples("mip.txt", "mip");
}

TEST(GoldenVectors, MavlinkIsAskedAsDescribed) {
  for (const GoldenVector& vector : read_vectors("mavlink_request.txt")) {
    SCOPED_TRACE(vector.name);
    const Fields fields = fields_in(vector);
    RigProfile profile;
    profile.gyro.protocol = "mavlink";
    profile.gyro.output_rate_hz = std::stod(fields.at("rate_hz"));
    for (const char* setting : {"system", "component", "message", "raw_scale_dps"})
      if (fields.contains(setting)) profile.gyro.settings[setting] = std::stod(fields.at(setting));
    const auto asked = static_cast<unsigned>(count_in(fields, "asked"));
    EXPECT_EQ(sensors::stream_request(Device::gyro, profile, asked), sensors::Commands{vector.bytes});
  }
}

}  // namespace
}  // namespace thermorig::test
