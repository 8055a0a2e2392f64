// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <tuple>

#include "program.h"
#include "simulation/gyro.h"
#include "support/telemetry_bytes.h"
#include "thermorig/sensors/wire/device_bytes.h"
#include "thermorig/sensors/wire/servo_messages.h"

namespace thermorig::tests {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
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

class Decode : public ProgramTest {
 protected:
  Outcome run_on_text(const std::string& options, const std::string& text) const {
    write("dump.txt", {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
    return run("decode --device gyro " + options + " dump.txt");
  }
};

TEST_F(Decode, NamesTheNearestOfTheGyroProtocolsForAnUnknownOne) {
  const Outcome outcome = run("decode --device gyro --gyro-protocol witmoton dump.bin");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("did you mean \"witmotion\"?"));
  EXPECT_THAT(outcome.err, HasSubstr("text"));
}

/// RAW_IMU of a flight controller: 100 a second, about x as many deg/s as its number.
Bytes controller_dump(int samples) {
  const GyroProfile profile{
      .protocol = "mavlink", .settings = {{"raw_scale_dps", 0.0625}}, .output_rate_hz = 100.0};
  Bytes dump;
  for (int i = 0; i < samples; ++i) {
    simulation::SimulatedGyroSample sample;
    sample.rate_dps = {static_cast<double>(i), -0.0625, 0.0};
    sample.index = static_cast<std::uint64_t>(i);
    sample.device_time_us = 10'000 * i;
    append(dump, simulation::gyro_encoder(profile).bytes(sample, profile));
  }
  return dump;
}

TEST_F(Decode, ReadsAFlightControllerWhoseScaleIsSaid) {
  write("dump.bin", controller_dump(20));
  const std::string mavlink = "decode --device gyro --gyro-protocol mavlink ";
  const Outcome outcome = run(mavlink + "--gyro-setting raw_scale_dps=0.0625 --json dump.bin");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto lines = outcome.lines();
  ASSERT_EQ(lines.size(), 21U);
  EXPECT_EQ(lines[19]["rate_dps"], nlohmann::json({19.0, -0.0625, 0.0}));
  EXPECT_EQ(lines[19]["device_time_us"], 190'000);
  EXPECT_EQ(lines[20]["counters"]["replies"], 1);  // the heartbeat
  EXPECT_EQ(run(mavlink + "dump.bin").code, 4);    // counts without a scale are no rates
  const Outcome misspelt = run(mavlink + "--gyro-setting raw_scale=1 dump.bin");
  EXPECT_EQ(misspelt.code, 2);
  EXPECT_THAT(misspelt.err, HasSubstr("raw_scale_dps"));
}

TEST_F(Decode, SaysThatADumpIsAFlightControllers) {
  GyroProfile profile{.protocol = "mavlink"};
  Bytes dump;
  for (int i = 0; i < 20; ++i)
    append(dump, simulation::gyro_encoder(profile).bytes({.index = static_cast<std::uint64_t>(i)}, profile));
  write("dump.bin", dump);
  EXPECT_THAT(run("decode --device gyro --gyro-protocol witmotion dump.bin").err,
              HasSubstr("--gyro-protocol mavlink"));
  EXPECT_THAT(run("decode --device gyro dump.bin").out, HasSubstr("read  mavlink, message 26"));
  EXPECT_THAT(run("decode --device camera dump.bin").err, HasSubstr("--device gyro --gyro-protocol mavlink"));
}

TEST_F(Decode, ReadsTheLinesOfASketchThatIsNamedUnlessTheySayOtherwise) {
  std::string text, other;
  for (int i = 0; i < 9; ++i) {
    text += fmt::format("Rotation X: 0.0{}, Y: -0.02, Z: 0.35 rad/s\r\n", i);
    other += fmt::format("Rotation X: 0.{}, Y: -1.20, Z: 20.05 deg/s\r\n", i);
  }
  write("dump.txt", Bytes(text.begin(), text.end()));
  write("other.txt", Bytes(other.begin(), other.end()));
  const std::string named = "decode --device gyro --gyro-protocol adafruit-mpu6050 ";
  EXPECT_NEAR(run(named + "--json dump.txt").lines().at(0)["rate_dps"][2], 20.054, 1e-3);
  const Outcome refused = run(named + "other.txt");
  EXPECT_EQ(refused.code, 4);
  EXPECT_THAT(refused.err, HasSubstr("adafruit-mpu6050 prints rad/s"));
  EXPECT_THAT(run("decode --device gyro dump.txt").out, HasSubstr("adafruit-mpu6050"));
}

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
  EXPECT_EQ(run("decode --device gyro --json dump.bin").lines().size(), 26U);
  EXPECT_EQ(run("decode --device gyro --json --lines 4 dump.bin").lines().size(), 5U);
}

TEST_F(Decode, PrintsAMessageInOneLineUnlessATerminalIsNarrower) {
  write("dump.bin", gyro_dump(3));
  setenv("COLUMNS", "40", 1);
  const std::string in_a_file = run("decode --device gyro dump.bin").out;
  const std::string on_a_terminal = run_on_terminal("COLUMNS=60", "decode --device gyro dump.bin").out;
  EXPECT_THAT(in_a_file, ContainsRegex("sample 1 [^\n]* degC\n"));
  EXPECT_THAT(on_a_terminal, Not(ContainsRegex("sample 1 [^\n]* degC")));
}

TEST_F(Decode, ReadsStandardInput) {
  write("dump.bin", gyro_dump(7));
  const Outcome outcome = run("decode --device gyro --json - <dump.bin");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.lines().back()["messages_decoded"], 7);
}

TEST_F(Decode, ReadsLinesOfTextWithChosenColumns) {
  const Outcome outcome =
      run_on_text("--gyro-protocol text --prefix G, --columns 1,2,3 --time-column 0 --scale 2 --json",
                  "G,10,1.5,2.5,3.5\nG,20,4.5,5.5,6.5\n");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto lines = outcome.lines();
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_EQ(lines[1]["rate_dps"], nlohmann::json({9.0, 11.0, 13.0}));
  EXPECT_EQ(lines[1]["device_time_us"], 20000);
}

TEST_F(Decode, ReadsEveryLineOfAFileFromItsFirstOn) {
  const Outcome outcome = run_on_text("--gyro-protocol text --json", "1,2,3\n4,5,6\n7,8,9\n");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  ASSERT_EQ(outcome.lines().size(), 4U);
  EXPECT_EQ(outcome.lines()[0]["lost_before"], false);
  EXPECT_EQ(outcome.lines()[0]["temp_c"], nullptr);
  EXPECT_EQ(outcome.lines()[0]["device_time_us"], nullptr);
}

TEST_F(Decode, ShowsALineAndTheOptionsThatMayReadItWhereNoneCouldBeRead) {
  std::string text;
  for (int i = 0; i < 9; ++i) text += "a/g:\t1\t2\t3\t4\t5\t6\r\n";
  for (const char* options :
       {"--gyro-protocol witmotion", "--prefix G,", "--gyro-protocol text --prefix G,"}) {
    const Outcome outcome = run_on_text(options, text);
    EXPECT_EQ(outcome.code, 4);
    EXPECT_THAT(outcome.err, HasSubstr("\"a/g:\\t1\\t2\\t3\\t4\\t5\\t6\" (7 columns)"));
    EXPECT_THAT(outcome.err,
                HasSubstr("--gyro-protocol text --prefix 'a/g:' --columns 3,4,5 --scale 0.00763359"));
  }
  EXPECT_EQ(run_on_text("--gyro-protocol text --prefix a/g: --columns 3,4,5 --scale 0.00763359", text).code,
            0);
}

std::string lines_of(const char* format) {
  std::string text;
  for (int i = 10; i < 30; ++i) text += fmt::format(fmt::runtime(format), i) + "\r\n";
  return text;
}

TEST_F(Decode, RecognisesAGyroByTheWordsOnItsLines) {
  const std::string text =
      lines_of("Accel X: 0.{0} Y: 0.2 Z: 9.8 m/s^2\nRotation X: 0.{0}, Y: -0.02, Z: 0.35 rad/s");
  const Outcome outcome = run_on_text("", text);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("line  Rotation X: 0.10, Y: -0.02, Z: 0.35 rad/s\n"));
  EXPECT_THAT(outcome.out,
              HasSubstr("read  prefix \"Rotation X:\", columns 0,2,4 as x,y,z, 57.2958 deg/s a unit"));
  EXPECT_THAT(outcome.out, HasSubstr("their unit is rad/s, as the words say"));
  EXPECT_THAT(outcome.out, HasSubstr("z   +20.054 deg/s"));
  EXPECT_THAT(outcome.out, HasSubstr("note  2 decimals are steps of 0.573 deg/s"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("other columns")));
  const nlohmann::json summary = run_on_text("--json", text).lines().back();
  EXPECT_EQ(summary["gyro_protocol"], "text");
  EXPECT_EQ(summary["text_format"]["columns"], nlohmann::json({0, 2, 4}));
  EXPECT_EQ(summary["counters"]["messages"], 20);
}

TEST_F(Decode, AsksForWhatTheLinesDoNotSay) {
  for (const auto& [line, question, option] :
       {std::tuple{"{{\"gx\":0.{},\"gy\":0.2,\"gz\":0.3}}", "in which unit", "57.2958 for rad/s"},
        std::tuple{"GyX = {} | GyY = 2 | GyZ = 3", "how many counts are a deg/s", "1/131, 1/65.5"},
        std::tuple{"0.{},0.2,0.3", "the lines do not say which columns", "--columns 0,1,2"},
        std::tuple{"ypr\t{}.5\t2.1\t3.2", "angles, no rates", "rates in deg/s"},
        std::tuple{"0,{};1,20;-3,50", "decimal commas", "print points"}}) {
    const Outcome outcome = run_on_text("", lines_of(line));
    EXPECT_EQ(outcome.code, 4) << line;
    EXPECT_THAT(outcome.err, HasSubstr(question));
    EXPECT_THAT(outcome.err, HasSubstr(option));
    EXPECT_THAT(outcome.err, Not(HasSubstr("baud")));
  }
}

TEST_F(Decode, BlamesTheBaudRateOfBytesWithoutSense) {
  Bytes noise;
  for (std::uint32_t i = 0, random = 7; i < 20000; ++i)
    noise.push_back(static_cast<std::uint8_t>((random = random * 1664525U + 1013904223U) >> 24U));
  write("noise.bin", noise);
  EXPECT_THAT(run("decode --device gyro noise.bin").err, HasSubstr("at another baud rate"));
}

TEST_F(Decode, NamesLinesThatAreLongerThanTheLimit) {
  std::string text;
  for (int i = 0; i < 20; ++i)
    text += fmt::format("gx_dps:{},gy_dps:2,gz_dps:3,{}\n", i, std::string(5000, '7'));
  EXPECT_THAT(run_on_text("", text).err, HasSubstr("its lines have 5027 bytes, the limit is 4096"));
  for (int i = 0; i < 40; ++i) text += "1,2,3\n";
  EXPECT_THAT(run_on_text("--gyro-protocol text", text).out, HasSubstr("note  20 lines were left out"));
}

TEST_F(Decode, ShowsTheFirstLineOfTextThatHoldsNoRates) {
  const Outcome outcome = run_on_text("--gyro-protocol text", "booting\ntemp 25\n");
  EXPECT_EQ(outcome.code, 4);
  EXPECT_THAT(outcome.err, HasSubstr("\"booting\" (1 column)"));
  EXPECT_THAT(outcome.err, HasSubstr("--columns"));
}

TEST_F(Decode, SaysThatMostLinesCouldNotBeRead) {
  const std::string text = "1,2,3\n4,5,6\n1,2,x\n1,2,x\n1,2,x\n";
  const Outcome outcome = run_on_text("--gyro-protocol text", text);
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.out, HasSubstr("most lines could not be read"));
  EXPECT_EQ(run_on_text("--gyro-protocol text --json", text).lines().back()["remarks"].size(), 1U);
}

TEST_F(Decode, RemarksOnColumnsThatAHeaderLineNamesOtherwise) {
  const std::string text = "t_s,gx_dps,gy_dps,gz_dps\n0.01,1,2,3\n0.02,1,2,3\n0.03,1,2,3\n";
  const Outcome outcome = run_on_text("--gyro-protocol text", text);
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, HasSubstr("--columns 1,2,3 --time-column 0 --time-unit 1"));
  const Outcome right =
      run_on_text("--gyro-protocol text --columns 1,2,3 --time-column 0 --time-unit 1", text);
  EXPECT_THAT(right.out, ::testing::Not(HasSubstr("note")));
}

TEST_F(Decode, TakesTheLastFrameWithoutAChecksumAndTheOnlyPacketOfAGyro) {
  Bytes frames = camera_dump(3);
  for (std::size_t end = 1; end <= 3; ++end) frames[end * wire::camera_frame_bytes - 1] ^= 0x55U;
  write("frames.bin", frames);
  const Outcome camera = run("decode --device camera --camera-checksum ignore --json frames.bin");
  EXPECT_EQ(camera.lines().back()["messages_decoded"], 3);
  const Outcome advised = run("decode --device camera frames.bin");
  EXPECT_EQ(advised.code, 4);
  EXPECT_THAT(advised.err, HasSubstr("--camera-checksum ignore"));

  write("packet.bin", gyro_dump(1));
  EXPECT_EQ(run("decode --device gyro --json packet.bin").lines().back()["messages_decoded"], 1);
}

TEST_F(Decode, SaysWhichCheckSumFitsWhereTheProtocolIsRight) {
  write("frames.bin", camera_dump(3));
  const Outcome outcome = run("decode --device camera --camera-checksum byte frames.bin");
  EXPECT_EQ(outcome.code, 4);
  EXPECT_THAT(outcome.err, HasSubstr("try: --camera-checksum word"));
}

TEST_F(Decode, SaysThatADumpEndsWithinItsFirstFrame) {
  Bytes part = camera_dump(1);
  part.resize(1000);
  write("part.bin", part);
  EXPECT_THAT(run("decode --device camera part.bin").err, HasSubstr("try: a longer dump"));
}

TEST_F(Decode, ShowsTelemetryOfTheServo) {
  const auto bytes = test::telemetry_bytes(0, {.mcu_us = 1'000'000,
                                               .angle_deg = 12.5,
                                               .rate_dps = -80.0,
                                               .pulse_us = 1500.0F,
                                               .motion = ServoMotion::steady,
                                               .leg = 4});
  write("dump.bin", bytes);
  const Outcome outcome = run("decode --device servo dump.bin");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("-80.00 deg/s pulse 1500.0 us steady"));
  EXPECT_THAT(outcome.out, HasSubstr("leg 4"));
}

TEST_F(Decode, RemarksThatAGyroZeroesItself) {
  Bytes dump = gyro_dump(200);
  write("moving.bin", dump);
  EXPECT_EQ(run("decode --device gyro --json moving.bin").lines().back()["remarks"].size(), 0U);
  for (int i = 0; i < 1000; ++i) append(dump, wire::witmotion_gyro_packet({0, 0, 0}, 30.0F));
  write("zeroed.bin", dump);
  const Outcome outcome = run("decode --device gyro zeroed.bin");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("note  the rates are exactly 0 on all axes for 1,000 samples in a row"));
  EXPECT_THAT(outcome.out, HasSubstr("hides its bias"));
}

TEST_F(Decode, SaysWhoseBytesTheyAreIfNotTheNamedDevices) {
  write("dump.bin", gyro_dump(100));
  const Outcome outcome = run("decode --device camera dump.bin");
  EXPECT_EQ(outcome.code, 4);
  EXPECT_THAT(outcome.err, HasSubstr("not one message of a camera in 1,100 bytes"));
  EXPECT_THAT(outcome.err, HasSubstr("--device gyro"));
}

TEST_F(Decode, ReadsAnImageAsTextAsACamerasAndTakesItForNoGyro) {
  std::string row = "23.45";
  for (int i = 1; i < 768; ++i) row += ", 23.45";
  std::string text;
  for (int i = 0; i < 8; ++i) text += row + "\n";
  write("dump.txt", {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  const Outcome camera = run("decode --device camera --json dump.txt");
  EXPECT_EQ(camera.code, 0) << camera.err;
  EXPECT_EQ(camera.lines().back()["messages_decoded"], 8);
  const Outcome gyro = run("decode --device gyro dump.txt");
  EXPECT_EQ(gyro.code, 4);
  EXPECT_THAT(gyro.err, HasSubstr("--device camera"));
}

TEST_F(Decode, RefusesAFileThatIsEmptyMissingOrAFolder) {
  write("empty.bin", {});
  EXPECT_EQ(run("decode --device camera empty.bin").code, 4);
  EXPECT_EQ(run("decode --device camera missing.bin").code, 2);
  EXPECT_EQ(run("decode --device camera .").code, 2);
}

}  // namespace
}  // namespace thermorig::tests
