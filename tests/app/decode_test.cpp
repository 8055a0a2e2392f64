// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include "program.h"
#include "thermorig/wire/device_bytes.h"
#include "thermorig/wire/servo_messages.h"

namespace thermorig::tests {
namespace {

using ::testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

void append(Bytes& to, std::span<const std::uint8_t> bytes) {
  to.insert(to.end(), bytes.begin(), bytes.end());
}

Bytes camera_dump(int frames) {
  Bytes dump;
  for (int i = 0; i < frames; ++i) {
    ThermalFrame frame;
    frame.temp_c.fill(20.0F + static_cast<float>(i));
    append(dump, wire::camera_frame(frame));
  }
  return dump;
}

Bytes gyro_dump(int samples) {
  Bytes dump;
  for (std::int16_t i = 0; i < samples; ++i) append(dump, wire::witmotion_gyro_packet({0, 0, i}, 30.0F));
  return dump;
}

class Decode : public ProgramTest {};

TEST_F(Decode, CountsTheFramesAndEveryByte) {
  Bytes dump{1, 2, 3};
  append(dump, camera_dump(12));
  write("dump.bin", dump);
  const Outcome outcome = run("decode --device camera --json dump.bin");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto lines = outcome.lines();
  ASSERT_EQ(lines.size(), 13U);
  EXPECT_EQ(lines[0]["event"], "frame");
  EXPECT_EQ(lines[0]["byte"], 3);
  EXPECT_EQ(lines[3]["temp_c"].size(), 768U);
  EXPECT_EQ(lines[3]["temp_c"][5], 23.0);
  const auto& counters = lines.back()["counters"];
  EXPECT_EQ(lines.back()["event"], "summary");
  EXPECT_EQ(counters["messages"], 12);
  EXPECT_EQ(counters["bytes_received"], dump.size());
  EXPECT_EQ(counters["bytes_skipped"], 3);
}

TEST_F(Decode, PrintsTheFirstFewMessagesUnlessAllAreAskedFor) {
  write("dump.bin", gyro_dump(25));
  const Outcome few = run("decode --device gyro --lines 4 dump.bin");
  EXPECT_EQ(few.code, 0);
  EXPECT_THAT(few.out, HasSubstr("sample 3 "));
  EXPECT_THAT(few.out, ::testing::Not(HasSubstr("sample 4 ")));
  EXPECT_THAT(few.out, HasSubstr("and 21 more"));
  EXPECT_THAT(run("decode --device gyro --all dump.bin").out, HasSubstr("sample 24 "));
}

TEST_F(Decode, ReadsStandardInput) {
  write("dump.bin", gyro_dump(7));
  const Outcome outcome = run("decode --device gyro --json - <dump.bin");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.lines().back()["messages_decoded"], 7);
}

TEST_F(Decode, ReadsLinesOfTextWithChosenColumns) {
  const std::string text = "G,10,1.5,2.5,3.5\nG,20,4.5,5.5,6.5\n";
  write("dump.txt", {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  const Outcome outcome =
      run("decode --device gyro --gyro-protocol text --prefix G, --columns 1,2,3 --time-column 0 --scale 2 "
          "--json dump.txt");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto lines = outcome.lines();
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_EQ(lines[1]["rate_dps"], nlohmann::json({9.0, 11.0, 13.0}));
  EXPECT_EQ(lines[1]["device_time_us"], 20000);
}

TEST_F(Decode, ShowsTelemetryOfTheServo) {
  const auto bytes = wire::telemetry_bytes(0, {.mcu_us = 1'000'000,
                                               .angle_deg = 12.5,
                                               .rate_dps = -80.0,
                                               .pulse_ticks = 3000,
                                               .motion = ServoMotion::steady,
                                               .leg = 4});
  write("dump.bin", bytes);
  const Outcome outcome = run("decode --device servo dump.bin");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("-80.00 deg/s"));
  EXPECT_THAT(outcome.out, HasSubstr("leg 4"));
}

TEST_F(Decode, SaysWhoseBytesTheyAreIfNotTheNamedDevices) {
  write("dump.bin", gyro_dump(100));
  const Outcome outcome = run("decode --device camera dump.bin");
  EXPECT_EQ(outcome.code, 4);
  EXPECT_THAT(outcome.err, HasSubstr("not one message of a camera in 1,100 bytes"));
  EXPECT_THAT(outcome.err, HasSubstr("--device gyro"));
}

TEST_F(Decode, RefusesAFileThatIsEmptyMissingOrAFolder) {
  write("empty.bin", {});
  EXPECT_EQ(run("decode --device camera empty.bin").code, 4);
  EXPECT_EQ(run("decode --device camera missing.bin").code, 2);
  EXPECT_EQ(run("decode --device camera .").code, 7);
}

}  // namespace
}  // namespace thermorig::tests
