// SPDX-License-Identifier: MIT
#include "thermorig/rig/sweep/sweep_recovery.h"

#include <gmock/gmock.h>

#include "support/at_s.h"
#include "test_servos.h"
#include "thermorig/rig/sweep/servo_commander.h"
#include "thermorig/sensors/wire/servo_messages.h"

namespace thermorig::rig::test {
namespace {

using ::testing::HasSubstr;

TimedServo telemetry(double time_s, ServoMotion motion, double angle_deg = 0.0,
                     ServoFault fault = ServoFault::none) {
  TimedServo servo;
  servo.state = {.angle_deg = angle_deg, .motion = motion, .fault = fault};
  servo.stamp.time = servo.stamp.arrival = at_s(time_s);
  return servo;
}

/// A commander whose servo acknowledges everything.
struct WillingServo {
  WillingServo() {
    commander.greet();
    answer_all(wire::ServoWelcome{.version = SERVO_LINK_VERSION, .firmware = "1.2.3"});
  }
  void answer_all(const wire::ServoWelcome& welcome = {}) {
    for (int i = 0; !commander.idle(); ++i) {
      commander.poll(at_s(0.1 * i));
      const auto number = static_cast<std::uint8_t>(sequence++);
      commander.answer({.body = welcome, .sequence = number}, at_s(0.1 * i));
      for (const std::uint8_t type : {SERVO_DISARM, SERVO_CONFIGURE, SERVO_ARM, SERVO_HALT})
        commander.answer({.body = wire::ServoAck{.type = type, .mcu_us = 1}, .sequence = number},
                         at_s(0.1 * i));
    }
  }
  ServoCommander commander{servo_of(270.0)};
  int sequence = 0;
};

TEST(ServoTelemetry, BeforeItHasComeProvesNothing) {
  const ServoTelemetry nothing;
  EXPECT_FALSE(nothing.at_rest());
  EXPECT_FALSE(nothing.is_disarmed());
  EXPECT_FALSE(nothing.is_recent(at_s(0.0)));
  EXPECT_EQ(nothing.fault(), ServoFault::none);
  EXPECT_EQ(nothing.arm_angle_deg(servo_of(270.0)), 0.0);
}

TEST(ServoTelemetry, ArmsWhereTheShaftWasLeftNotWhereADisarmedServoSaysItIs) {
  ServoTelemetry servo;
  servo.take(telemetry(1.0, ServoMotion::holding, 40.0));
  servo.take(telemetry(2.0, ServoMotion::disarmed, 0.0));
  EXPECT_EQ(servo.arm_angle_deg(servo_of(270.0)), 40.0);
  servo.take(telemetry(3.0, ServoMotion::holding, 400.0));
  EXPECT_EQ(servo.arm_angle_deg(servo_of(270.0)), angle_limit_deg(servo_of(270.0)));
}

TEST(ServoTelemetry, AFaultFromBeforeTheArmingIsNoNews) {
  ServoTelemetry servo;
  servo.take(telemetry(1.0, ServoMotion::holding, 0.0, ServoFault::watchdog));
  servo.armed(at_s(1.5));
  EXPECT_FALSE(servo.is_newer_than_arming());
  servo.take(telemetry(1.6, ServoMotion::holding));
  EXPECT_TRUE(servo.is_newer_than_arming());
}

TEST(SweepRecovery, CountsEachTroubleAndGivesUpAfterFiveInARow) {
  WillingServo servo;
  SweepRecovery recovery(servo.commander);
  for (int i = 0; i < 5; ++i) recovery.count_failure("the servo stopped", ServoFault::none);
  EXPECT_THROW(recovery.count_failure("the servo's watchdog tripped", ServoFault::watchdog), Error);
  ASSERT_EQ(recovery.troubles().size(), 2U);
  EXPECT_EQ(recovery.troubles()[0].count, 5);
  EXPECT_THAT(recovery.troubles()[1].advice, HasSubstr("too busy"));
}

TEST(SweepRecovery, GivesUpWhenADeviceGoesForTheSixthTimeWithinALeg) {
  WillingServo servo;
  SweepRecovery recovery(servo.commander);
  const Error gone(ExitCode::device_lost, "gone", "gyro", "");
  for (int i = 0; i < 5; ++i) EXPECT_NO_THROW(recovery.device_went(SweepPhase::leg, gone));
  EXPECT_THROW(recovery.device_went(SweepPhase::leg, gone), Error);
}

TEST(SweepRecovery, ForgetsFailuresWithALegThatWasDriven) {
  WillingServo servo;
  SweepRecovery recovery(servo.commander);
  for (int i = 0; i < 12; ++i) {
    EXPECT_NO_THROW(recovery.count_failure("the servo stopped", ServoFault::none));
    EXPECT_NO_THROW(recovery.device_went(SweepPhase::leg, Error(ExitCode::device_lost, "gone", "gyro", "")));
    if (i % 4 == 3) recovery.leg_was_driven();
  }
}

TEST(SweepRecovery, ArmsAgainAfterARestThatDoublesWithEachFailure) {
  WillingServo servo;
  SweepRecovery recovery(servo.commander);
  for (const double rest_s : {0.5, 1.0, 2.0}) {
    recovery.count_failure("the servo stopped", ServoFault::none);
    recovery.begin_after_failure(SweepPhase::leg);
    EXPECT_FALSE(recovery.is_armed_again(rest_s - 0.01, true, 10.0));
    EXPECT_TRUE(servo.commander.idle()) << "armed before its rest of " << rest_s << " s";
    EXPECT_FALSE(recovery.is_armed_again(rest_s, true, 10.0));
    EXPECT_FALSE(servo.commander.idle()) << "not armed after " << rest_s << " s";
    servo.answer_all();
    EXPECT_TRUE(recovery.is_armed_again(rest_s + 0.1, true, 10.0));
    EXPECT_FALSE(recovery.finish(rest_s + 0.1));
    EXPECT_EQ(recovery.interrupted(), SweepPhase::leg);
  }
}

TEST(SweepRecovery, AFaultWhileRecoveringLeavesThePhaseThatWasInterrupted) {
  WillingServo servo;
  SweepRecovery recovery(servo.commander);
  recovery.begin_after_failure(SweepPhase::closing_rest);
  recovery.begin_after_failure(SweepPhase::recovering);
  EXPECT_EQ(recovery.interrupted(), SweepPhase::closing_rest);
}

TEST(SweepRecovery, EndsWhereTheServoCannotBeArmedAgain) {
  WillingServo servo;
  SweepRecovery recovery(servo.commander);
  recovery.count_failure("the servo stopped", ServoFault::none);
  EXPECT_NO_THROW(recovery.check_patience(5.5));
  EXPECT_THROW(recovery.check_patience(5.6), Error);
}

TEST(ServoStop, DisarmsAServoThatHasComeToRest) {
  WillingServo servo;
  ServoStop stop(servo.commander);
  ServoTelemetry telemetered;
  telemetered.take(telemetry(1.0, ServoMotion::steady));
  EXPECT_FALSE(stop.has_halted(from_s(0.1), telemetered));
  EXPECT_FALSE(stop.is_disarming());
  telemetered.take(telemetry(1.1, ServoMotion::holding));
  EXPECT_FALSE(stop.has_halted(from_s(0.2), telemetered));
  EXPECT_TRUE(stop.is_disarming());
  servo.answer_all();
  telemetered.take(telemetry(1.2, ServoMotion::disarmed));
  EXPECT_TRUE(stop.has_halted(from_s(0.3), telemetered));
}

TEST(ServoStop, GivesUpOnAServoThatDoesNotComeToRest) {
  WillingServo servo;
  ServoStop stop(servo.commander);
  ServoTelemetry telemetered;
  telemetered.take(telemetry(1.0, ServoMotion::steady));
  EXPECT_FALSE(stop.has_halted(from_s(5.0), telemetered));
  EXPECT_THROW(stop.has_halted(from_s(5.1), telemetered), Error);
}

TEST(ServoStop, OnRequestTrustsNoTelemetryFromBefore) {
  WillingServo servo;
  ServoStop stop(servo.commander);
  ServoTelemetry telemetered;
  telemetered.take(telemetry(1.0, ServoMotion::disarmed));
  EXPECT_TRUE(stop.request());
  servo.answer_all();
  EXPECT_EQ(stop.requested_at(at_s(1.0), at_s(1.01), telemetered), ServoStop::Request::under_way);
  EXPECT_FALSE(stop.is_disarming());
  EXPECT_EQ(stop.requested_at(at_s(1.0), at_s(2.1), telemetered), ServoStop::Request::unconfirmed);
  telemetered.take(telemetry(1.5, ServoMotion::disarmed));
  EXPECT_EQ(stop.requested_at(at_s(1.0), at_s(1.6), telemetered), ServoStop::Request::under_way);
  servo.answer_all();
  EXPECT_EQ(stop.requested_at(at_s(1.0), at_s(1.7), telemetered), ServoStop::Request::confirmed);
}

}  // namespace
}  // namespace thermorig::rig::test
