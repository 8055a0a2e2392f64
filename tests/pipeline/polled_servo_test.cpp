// SPDX-License-Identifier: MIT
// Servos that are asked for their telemetry, by a host that is busy or whose cable loses an answer.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "thermorig/pipeline/pipeline.h"
#include "thermorig/sensors/servo_protocol.h"
#include "thermorig/sensors/wire/dynamixel.h"
#include "thermorig/sensors/wire/sts3215.h"

namespace thermorig::pipeline {
namespace {

using PolledBytes = std::vector<std::uint8_t>;

/// Sends reads and answers to a pipeline at chosen instants, in milliseconds.
class PolledServo {
 public:
  explicit PolledServo(const std::string& protocol) : pipeline_(profile(protocol)) {
    request_ = sensors::servo_protocol(protocol).telemetry_request(profile(protocol).servo);
  }

  void ask(double ms) { send(ms, request_); }
  void send(double ms, const PolledBytes& bytes) { pipeline_.sent(Device::servo, bytes, at(ms)); }
  Streams hear(double ms, const PolledBytes& answer) {
    pipeline_.feed(Device::servo, answer, at(ms));
    return pipeline_.take_streams();
  }
  static HostTime at(double ms) { return HostTime{} + from_s(10.0 + 1e-3 * ms); }

 private:
  static RigProfile profile(const std::string& protocol) {
    RigProfile profile;
    sensors::choose_servo(protocol, profile.servo);
    profile.servo.link.baud = 1'000'000;
    return profile;
  }
  Pipeline pipeline_;
  PolledBytes request_;
};

PolledBytes sts3215_telemetry() {
  return wire::sts3215::packet(1, 0, PolledBytes(wire::sts3215::telemetry_bytes, 0));
}

double since_ms(const TimedServo& servo, double ms) {
  return 1e3 * to_s(servo.stamp.time - PolledServo::at(ms));
}

TEST(PolledServo, ReadingsHaveTheTimeOfTheirRequest) {
  PolledServo servo("sts3215");
  servo.ask(0);
  const Streams heard = servo.hear(17, sts3215_telemetry());
  ASSERT_EQ(heard.servo.size(), 1U);
  EXPECT_NEAR(since_ms(heard.servo[0], 0), 0.6, 0.2);
  EXPECT_EQ(heard.shaft.size(), 1U);
}

TEST(PolledServo, WhatElseIsSentMeanwhileIsNoRequest) {
  PolledServo servo("sts3215");
  servo.ask(0);
  servo.send(10, sensors::servo_protocol("sts3215").emergency_bytes());
  const Streams heard = servo.hear(17, sts3215_telemetry());
  EXPECT_NEAR(since_ms(heard.servo.at(0), 0), 0.6, 0.2);
}

TEST(PolledServo, AnOldAnswerThatIsReadAfterANewRequestDoesNotGetItsTime) {
  PolledServo servo("sts3215");
  servo.ask(0);
  servo.ask(300);
  const Streams old = servo.hear(302, sts3215_telemetry());
  ASSERT_EQ(old.servo.size(), 1U);
  EXPECT_TRUE(old.shaft.empty());
  EXPECT_GE(since_ms(old.servo[0], 0), 1e3 * double{old.servo[0].stamp.earlier_s} - 0.1);
  EXPECT_GT(old.servo[0].stamp.earlier_s, 0.29F);
  EXPECT_GT(old.servo[0].stamp.uncertainty_s, 0.1F);
  const Streams newer = servo.hear(317, sts3215_telemetry());
  EXPECT_NEAR(since_ms(newer.servo.at(0), 300), 0.6, 0.2);
  EXPECT_EQ(newer.shaft.size(), 1U);
}

PolledBytes dynamixel_telemetry(int tick_ms) {
  namespace dynamixel = wire::dynamixel;
  PolledBytes parameters(1 + dynamixel::telemetry_bytes, 0);  // behind the error
  const std::size_t tick = 1 + dynamixel::at::tick - dynamixel::telemetry_begin;
  parameters[tick] = static_cast<std::uint8_t>(tick_ms & 0xFF);
  parameters[tick + 1] = static_cast<std::uint8_t>(tick_ms >> 8);
  return dynamixel::packet(1, dynamixel::Instruction::status, parameters);
}

/// The servo's clock is 1 s ahead; a false proof would begin it anew, or leave the true time out of its
/// bounds.
TEST(PolledServo, AnAnswerThatIsStillUnderWayProvesNothingOfALaterRequest) {
  PolledServo servo("dynamixel");
  for (int i = 0; i < 50; ++i) {
    servo.ask(24.0 * i);
    servo.hear(24.0 * i + 17.0, dynamixel_telemetry(1000 + 24 * i));
  }
  servo.ask(1200);
  servo.ask(1281);
  servo.hear(1283, dynamixel_telemetry(2200));  // the first one's
  servo.send(1284, sensors::servo_protocol("dynamixel").emergency_bytes());
  servo.ask(1290);
  const Streams heard = servo.hear(1298, dynamixel_telemetry(2281));  // the second one's
  EXPECT_TRUE(heard.servo_epochs.empty());
  ASSERT_EQ(heard.servo.size(), 1U);
  const Stamp& stamp = heard.servo[0].stamp;
  constexpr double tick_ms = 1.0;
  EXPECT_LE(since_ms(heard.servo[0], 1281) - 1e3 * double{stamp.earlier_s}, tick_ms);
  EXPECT_GE(since_ms(heard.servo[0], 1281) + 1e3 * double{stamp.later_s}, 0.0);
}

}  // namespace
}  // namespace thermorig::pipeline
