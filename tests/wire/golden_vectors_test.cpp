// SPDX-License-Identifier: MIT
// The camera's golden vectors: protocols/vectors/gy_mcu90640.txt.
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "camera_stream.h"
#include "support/camera_commands.h"
#include "vector_fields.h"

namespace thermorig::test {
namespace {

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
  EXPECT_EQ(camera_command(gy_mcu90640::command_rate, 0), commands.at("command_rate_0.5"));
  EXPECT_EQ(camera_command(gy_mcu90640::command_rate, 1), commands.at("command_rate_1"));
  EXPECT_EQ(camera_command(gy_mcu90640::command_rate, 2), commands.at("command_rate_2"));
  EXPECT_EQ(camera_command(gy_mcu90640::command_rate, 3), commands.at("command_rate_4"));
  EXPECT_EQ(camera_command(gy_mcu90640::command_rate, 4), commands.at("command_rate_8"));
  EXPECT_EQ(camera_command(gy_mcu90640::command_output, gy_mcu90640::output_query),
            commands.at("command_query"));
  EXPECT_EQ(camera_command(gy_mcu90640::command_output, gy_mcu90640::output_automatic),
            commands.at("command_automatic"));
  EXPECT_EQ(camera_command(gy_mcu90640::command_read_emissivity, 1), commands.at("command_read_emissivity"));
  EXPECT_EQ(camera_emissivity_reply(95), commands.at("emissivity_reply"));
}

}  // namespace
}  // namespace thermorig::test
