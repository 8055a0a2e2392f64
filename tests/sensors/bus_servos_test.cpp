// SPDX-License-Identifier: MIT
// Servos that do not carry our firmware: Dynamixel, GRBL, STS3215.
#include "thermorig/sensors/wire/dynamixel.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "thermorig/sensors/device_stream.h"
#include "thermorig/sensors/servo_protocol.h"
#include "thermorig/sensors/wire/grbl.h"
#include "thermorig/sensors/wire/sts3215.h"
#include "wire/scan.h"
#include "wire/vector_fields.h"

namespace thermorig::test::bus_servo_protocols {
namespace {

namespace dynamixel = wire::dynamixel;
namespace grbl = wire::grbl;
namespace sts3215 = wire::sts3215;
using Bytes = std::vector<std::uint8_t>;

sensors::ServoScanner scanner_of(int id) {
  return sensors::servo_protocol("dynamixel").scanner({.bus_id = id});
}

void expect_described(const char* file, const sensors::ServoScanner& scanner) {
  for (const GoldenVector& vector : read_vectors(file)) {
    SCOPED_TRACE(vector.name);
    const Fields fields = fields_in(vector);
    const auto scan = scan_any_chunking<wire::ServoMessage>(scanner, vector.bytes, Stream::ends);
    expect_counters(scan.counters, fields, "telemetry");
    const auto count = [&](auto is_so) {
      return static_cast<std::uint64_t>(std::count_if(scan.messages.begin(), scan.messages.end(), is_so));
    };
    const auto is_state = [](const auto& message) {
      return std::holds_alternative<ServoState>(message.body);
    };
    const auto is_shaft = [](const auto& message) {
      return std::holds_alternative<ShaftReading>(message.body);
    };
    EXPECT_EQ(count(is_state), count_in(fields, "telemetry"));
    EXPECT_EQ(scan.messages.size() - count(is_state) - count(is_shaft),
              count_in(fields, "welcomes") + count_in(fields, "answers"));
    if (count(is_shaft) > 0) {
      EXPECT_EQ(count(is_shaft), count_in(fields, "telemetry"));
      EXPECT_NEAR(std::get<ShaftReading>(scan.messages.back().body).angle_deg,
                  std::stod(fields.at("shaft_deg")), 1e-9);
    }
    const auto last = std::find_if(scan.messages.rbegin(), scan.messages.rend(), is_state);
    ASSERT_NE(last, scan.messages.rend());
    const auto& state = std::get<ServoState>(last->body);
    EXPECT_NEAR(state.angle_deg, std::stod(fields.at("angle_deg")), 1e-9);
    EXPECT_NEAR(state.rate_dps, std::stod(fields.at("rate_dps")), 1e-9);
    EXPECT_EQ(state.mcu_us, count_in(fields, "mcu_us"));
    EXPECT_EQ(static_cast<std::uint64_t>(state.motion), count_in(fields, "motion"));
    EXPECT_EQ(static_cast<std::uint64_t>(state.fault), count_in(fields, "fault"));
    if (const auto* reply = std::get_if<wire::ServoReply>(&scan.messages.front().body)) {
      EXPECT_EQ(reply->error, count_in(fields, "error"));
    }
  }
}

TEST(Dynamixel, StreamsAreReadAsTheGoldenVectorsDescribe) {
  expect_described("dynamixel.txt", scanner_of(1));
}

TEST(Grbl, StreamsAreReadAsTheGoldenVectorsDescribe) {
  expect_described("grbl.txt", sensors::servo_protocol("grbl").scanner({}));
}

TEST(Sts3215, StreamsAreReadAsTheGoldenVectorsDescribe) {
  expect_described("sts3215.txt", sensors::servo_protocol("sts3215").scanner({}));
}

/// It says where it goes and how fast, but not whether its profile is still on the ramp.
TEST(Sts3215, IsSteadyFromWhereItHasItsSpeedToWhereItHasToBrakeHoweverUnevenItTurns) {
  constexpr int asked = 683, goal = 8000;
  sensors::ServoScanner scanner = sensors::servo_protocol("sts3215").scanner({});
  const auto motion_at = [&](int position, int speed) {
    Bytes memory(sts3215::telemetry_bytes);
    const auto put = [&](std::uint16_t address, int value) {
      Bytes two;
      sts3215::put_signed(value, two);
      std::copy(two.begin(), two.end(), memory.begin() + address - sts3215::telemetry_begin);
    };
    memory[0] = 1;
    memory[1] = 228;
    put(sts3215::at::goal_position, goal);
    put(sts3215::at::goal_speed, asked);
    put(sts3215::at::present_position, position);
    put(sts3215::at::present_speed, speed);
    memory[sts3215::at::moving - sts3215::telemetry_begin] = 1;
    std::vector<wire::ServoMessage> messages;
    scanner.push(sts3215::packet(1, 0, memory), messages);
    return std::get<ServoState>(messages.at(0).body).motion;
  };
  EXPECT_EQ(motion_at(2048, 300), ServoMotion::ramping);
  for (int i = 1; i < 6; ++i) EXPECT_EQ(motion_at(2100 + 14 * i, 600), ServoMotion::ramping);
  EXPECT_EQ(motion_at(2184, 600), ServoMotion::steady) << "its loop has caught up";
  EXPECT_EQ(motion_at(5000, 400), ServoMotion::steady) << "it sticks, and has not got another goal";
  EXPECT_EQ(motion_at(goal - 8, 400), ServoMotion::ramping);
}

TEST(Sts3215, IsRecognisedByOneAnswerAndItsIdIsNamedAndAnEchoIsNoServo) {
  const auto found = sensors::recognise(sts3215::packet(7, 0, {}), 1.0);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].protocol, "sts3215");
  EXPECT_EQ(found[0].evidence.settings.at("bus_id"), 7);
  EXPECT_TRUE(sensors::recognise(sts3215::ping(sts3215::every_id), 1.0).empty());
}

/// Reports have neither leg nor arming: what was sent says both.
TEST(Grbl, ReportsAreReadWithWhatWasSent) {
  sensors::ServoScanner scanner = sensors::servo_protocol("grbl").scanner({});
  std::vector<wire::ServoMessage> messages;
  const auto report = [&](const std::string& line) {
    const std::string ended = line + "\r\n";
    scanner.push(Bytes(ended.begin(), ended.end()), messages);
    return std::get<ServoState>(messages.back().body);
  };
  const std::string at_rest = "<Idle|MPos:0.000,0.000,0.000|FS:0,0>";
  EXPECT_EQ(report(at_rest).motion, ServoMotion::disarmed);
  scanner.sent(grbl::power_note(true));
  EXPECT_EQ(report(at_rest).motion, ServoMotion::holding);
  scanner.sent(grbl::jog_line({-6.0, 30.0, 7}));
  const ServoState driven = report("<Jog|MPos:-1.000,0.000,0.000|FS:1800,0>");
  EXPECT_EQ(driven.motion, ServoMotion::steady);
  EXPECT_EQ(driven.rate_dps, -30.0);
  EXPECT_EQ(driven.leg, 7);
  scanner.sent(Bytes{grbl::jog_cancel});
  EXPECT_EQ(report("<Jog|MPos:-2.000,0.000,0.000|FS:1800,0>").motion, ServoMotion::stopping);
  EXPECT_EQ(report(at_rest).leg, 0);
}

/// A rest has no lines, and ten requests a second.
TEST(Grbl, WhatIsSentAfterALongRestIsUnderstood) {
  sensors::ServoScanner scanner = sensors::servo_protocol("grbl").scanner({});
  scanner.sent(Bytes(600, grbl::status_request));
  scanner.sent(grbl::power_note(true));
  scanner.sent(Bytes(600, grbl::status_request));
  scanner.sent(grbl::jog_line({6.0, 30.0, 7}));
  std::vector<wire::ServoMessage> messages;
  const std::string report = "<Jog|MPos:1.000,0.000,0.000|FS:1800,0>\r\n";
  scanner.push(Bytes(report.begin(), report.end()), messages);
  const ServoState state = std::get<ServoState>(messages.at(0).body);
  EXPECT_EQ(state.leg, 7);
  EXPECT_EQ(state.motion, ServoMotion::steady);
}

TEST(Grbl, AScaleThatIsWrongIsThatOfItsStepsADegreeWhichAreNamed) {
  const auto scale_cause = sensors::servo_protocol("grbl").scale_cause;
  EXPECT_FALSE(scale_cause(0.9, {}));
  const std::string line = "$100=40.000";
  const wire::ServoMessage listed{.body = wire::ServoReply{.data = {line.begin(), line.end()}}, .span = {}};
  const auto cause = scale_cause(0.8, std::span(&listed, 1));
  ASSERT_TRUE(cause);
  EXPECT_THAT(cause->why, ::testing::HasSubstr("$100 = 40.000"));
  EXPECT_THAT(cause->remedy, ::testing::HasSubstr("$100=50.000"));
}

TEST(Grbl, IsRecognisedByItsBannerAlone) {
  const std::string banner = "\r\nGrbl 1.1h ['$' for help]\r\n";
  const auto found = sensors::recognise(Bytes(banner.begin(), banner.end()), 1.0);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found.front().role, Device::servo);
  EXPECT_EQ(found.front().protocol, "grbl");
}

TEST(Dynamixel, TelemetryBelongsToTheLegThatWasNotedBeforeItWasAskedFor) {
  const Bytes telemetry = read_vectors("dynamixel.txt").front().bytes;
  sensors::ServoScanner scanner = scanner_of(1);
  std::vector<wire::ServoMessage> messages;
  const auto ask = [&] {
    scanner.sent(dynamixel::read(1, dynamixel::telemetry_begin, dynamixel::telemetry_bytes));
  };
  const auto leg = [&] {
    messages.clear();
    scanner.push(telemetry, messages);
    return std::get<ServoState>(messages.front().body).leg;
  };
  ask();
  scanner.sent(dynamixel::note(515));
  EXPECT_EQ(leg(), 0);
  ask();
  EXPECT_EQ(leg(), 515);
  scanner.finish(messages);
  scanner.restart();
  EXPECT_EQ(leg(), 0);
}

TEST(Dynamixel, IsRecognisedByOneAnswerAndItsIdIsNamed) {
  const Bytes model_1060{0x24, 0x04, 0x2D};
  Bytes answer{0};
  answer.insert(answer.end(), model_1060.begin(), model_1060.end());
  const Bytes status = dynamixel::packet(7, dynamixel::Instruction::status, answer);
  const auto found = sensors::recognise(status, 1.0);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].role, Device::servo);
  EXPECT_EQ(found[0].protocol, "dynamixel");
  EXPECT_EQ(found[0].evidence.settings.at("bus_id"), 7);
  EXPECT_THAT(found[0].evidence.text, ::testing::HasSubstr("ID 7"));
}

TEST(Dynamixel, AnAdapterThatEchoesWhatItIsAskedIsNoServo) {
  Bytes echo = dynamixel::ping(dynamixel::every_id);
  const Bytes again = echo;
  echo.insert(echo.end(), again.begin(), again.end());
  EXPECT_TRUE(sensors::recognise(echo, 1.0).empty());
}

TEST(Dynamixel, IsAskedWhereNobodyElseSpeaksAndByAPingAlone) {
  bool is_asked = false;
  for (const sensors::SearchStep& step : sensors::search_steps()) {
    if (step.greeting != dynamixel::ping(dynamixel::every_id)) continue;
    is_asked = true;
    EXPECT_TRUE(step.only_if_silent) << step.at.baud;
  }
  EXPECT_TRUE(is_asked);
}

}  // namespace
}  // namespace thermorig::test::bus_servo_protocols
