// SPDX-License-Identifier: MIT
// The vendor protocols' golden vectors: protocols/vectors/{gy_mcu90640,witmotion,text_gyro}.txt.
#include <gtest/gtest.h>

#include <map>
#include <sstream>
#include <string>

#include "camera_stream.h"
#include "support/vectors.h"
#include "thermorig/wire/gyro_scanner.h"

namespace thermorig::test {
namespace {

using Fields = std::map<std::string, std::string>;

Fields fields_in(const GoldenVector& vector) {
  const auto pairs = fields_of(vector.meaning);
  return {pairs.begin(), pairs.end()};
}

std::uint64_t count_in(const Fields& fields, const std::string& name) {
  const auto found = fields.find(name);
  return found == fields.end() ? 0 : std::stoull(found->second);
}

/// "1,-2.5,3" as numbers.
std::vector<double> numbers_in(const std::string& text) {
  std::vector<double> numbers;
  std::istringstream in(text);
  for (std::string number; std::getline(in, number, ',');) numbers.push_back(std::stod(number));
  return numbers;
}

/// Counters that a vector does not name must be zero.
void expect_counters(const wire::Counters& counters, const Fields& fields, const std::string& messages) {
  EXPECT_EQ(counters.messages, count_in(fields, messages));
  EXPECT_EQ(counters.replies, count_in(fields, "replies"));
  EXPECT_EQ(counters.bad_checksum, count_in(fields, "bad_checksum"));
  EXPECT_EQ(counters.bad_length, count_in(fields, "bad_length"));
  EXPECT_EQ(counters.bad_value, count_in(fields, "bad_value"));
  EXPECT_EQ(counters.bytes_in_damaged, count_in(fields, "damaged"));
  EXPECT_EQ(counters.bytes_skipped, count_in(fields, "skipped"));
  EXPECT_EQ(counters.bytes_pending, count_in(fields, "pending"));
}

void expect_frame(const ThermalFrame& frame, const Fields& fields) {
  const std::string pixel = "temp_cdeg_";
  for (const auto& [name, value] : fields) {
    const float expected = std::stof(value) / 100.0F;
    if (name.starts_with(pixel)) {
      EXPECT_EQ(frame.temp_c.at(std::stoul(name.substr(pixel.size()))), expected) << name;
    } else if (name == "ta_cdeg") {
      EXPECT_EQ(frame.sensor_temp_c, expected);
    }
  }
}

TEST(GoldenVectors, CameraStreamsAreReadAsDescribed) {
  for (const GoldenVector& vector : read_vectors("gy_mcu90640.txt")) {
    if (vector.name.starts_with("command")) continue;
    SCOPED_TRACE(vector.name);
    const Fields fields = fields_in(vector);
    const auto scan = scan_camera(vector.bytes, ChecksumPolicy::word, Stream::ends);
    expect_counters(scan.counters, fields, "frames");
    ASSERT_EQ(scan.messages.size(), count_in(fields, "frames"));
    if (scan.messages.empty()) continue;
    expect_frame(scan.messages.back().frame, fields);
    if (fields.contains("encode")) {
      EXPECT_EQ(wire::camera_frame(scan.messages.back().frame), vector.bytes);
    }
  }
}

TEST(GoldenVectors, CameraCommandsAreEncodedAsDescribed) {
  std::map<std::string, ByteVector> commands;
  for (const GoldenVector& vector : read_vectors("gy_mcu90640.txt")) commands[vector.name] = vector.bytes;
  EXPECT_EQ(wire::camera_rate_command(0.5), commands.at("command_rate_0.5"));
  EXPECT_EQ(wire::camera_rate_command(1), commands.at("command_rate_1"));
  EXPECT_EQ(wire::camera_rate_command(2), commands.at("command_rate_2"));
  EXPECT_EQ(wire::camera_rate_command(4), commands.at("command_rate_4"));
  EXPECT_EQ(wire::camera_rate_command(8), commands.at("command_rate_8"));
  EXPECT_EQ(wire::camera_query_command(), commands.at("command_query"));
  EXPECT_EQ(wire::camera_automatic_command(), commands.at("command_automatic"));
  EXPECT_EQ(wire::camera_read_emissivity_command(), commands.at("command_read_emissivity"));
  EXPECT_EQ(wire::camera_emissivity_reply(95), commands.at("emissivity_reply"));
}

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

TEST(GoldenVectors, WitmotionStreamsAreReadAsDescribed) {
  for (const GoldenVector& vector : read_vectors("witmotion.txt")) {
    SCOPED_TRACE(vector.name);
    const Fields fields = fields_in(vector);
    const auto scan =
        scan_any_chunking<wire::GyroMessage>(wire::WitmotionScanner(), vector.bytes, Stream::ends);
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
    const wire::TextGyroScanner scanner(columns_in(fields));
    const auto scan = scan_any_chunking<wire::GyroMessage>(scanner, vector.bytes, Stream::ends);
    expect_counters(scan.counters, fields, "readings");
    ASSERT_EQ(scan.messages.size(), count_in(fields, "readings"));
    if (!scan.messages.empty()) expect_reading(scan.messages.back().reading, fields);
  }
}

}  // namespace
}  // namespace thermorig::test
