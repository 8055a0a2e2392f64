// SPDX-License-Identifier: MIT
#include "thermorig/rig/calibration/check.h"

#include <cmath>
#include <limits>

#include "calibrated_rig.h"
#include "thermorig/rig/calibration/calibration.h"

namespace thermorig::calibration {
namespace {

constexpr const char* yesterday = "2026-07-25T14:35:12Z";

/// A rig that was calibrated with all that a winch allows; other servos know the gyro's scale from a winch.
simulation::VirtualRigConfig calibrated_rig(std::uint64_t seed, const std::string& servo = "winch") {
  auto config = rig_with(seed);
  RigProfile& profile = config.profile;
  apply(measure_scale(record(config, plan_for(CalibrationKind::scale, config)).session), yesterday, profile);
  apply(measure_latency(record(config, plan_for(CalibrationKind::latency, config)).session), yesterday,
        profile);
  apply(measure_bias(record(config, plan_for(CalibrationKind::bias, config)).session), yesterday, profile);
  if (servo == "winch") return config;
  auto other = rig_with(seed, servo);
  other.profile.gyro = profile.gyro;
  other.profile.camera = profile.camera;
  return other;
}

std::vector<CheckedConstant> checked(const simulation::VirtualRigConfig& config) {
  return check_constants(record(config, plan_for(CalibrationKind::check, config)).session);
}

const CheckedConstant& constant(const std::vector<CheckedConstant>& constants, const std::string& name) {
  static const CheckedConstant none;
  for (const CheckedConstant& one : constants)
    if (one.name == name) return one;
  ADD_FAILURE() << "no constant " << name;
  return none;
}

std::string text(const CheckedConstant& one) {
  const auto value = [](const std::optional<Estimate>& estimate) {
    return estimate ? std::to_string(estimate->value) + " +- " + std::to_string(estimate->uncertainty) : "-";
  };
  return one.name + ": " + value(one.profile) + " | " + value(one.session) + " | " +
         std::string(name_of(one.verdict)) + " " + one.why;
}

std::vector<std::string> contradicted(const std::vector<CheckedConstant>& constants) {
  std::vector<std::string> names;
  for (const CheckedConstant& one : constants)
    if (one.verdict == ConstantVerdict::contradicts) names.push_back(one.name);
  return names;
}

void expect_sound(std::uint64_t seed, const std::string& servo, const std::vector<std::string>& holding) {
  const auto constants = checked(calibrated_rig(seed, servo));
  for (const CheckedConstant& one : constants)
    EXPECT_NE(one.verdict, ConstantVerdict::contradicts) << servo << seed << " " << text(one);
  for (const std::string& name : holding)
    EXPECT_EQ(constant(constants, name).verdict, ConstantVerdict::holds)
        << servo << seed << " " << text(constant(constants, name));
}

TEST(CheckConstants, ASoundProfileHolds) {
  expect_sound(4, "winch",
               {"gyro scale", "gyro bias", "gyro filter delay", "camera latency", "camera rows",
                "servo scale", "servo at +200 deg/s", "servo at -75 deg/s"});
}

TEST(CheckConstants, ASoundProfileOfOtherServosHoldsAsFarAsItCanBeChecked) {
  expect_sound(1, "continuous", {"gyro scale", "gyro bias", "camera latency", "servo at +200 deg/s"});
  expect_sound(1, "270", {"gyro bias", "gyro filter delay", "camera latency", "servo at +200 deg/s"});
}

TEST(CheckConstants, EachThatChangedContradictsAndNamesItsCommand) {
  using Names = std::vector<std::string>;
  const simulation::VirtualRigConfig sound = calibrated_rig(2);

  auto rescaled = sound;
  rescaled.profile.gyro.scale *= 1.03;
  auto constants = checked(rescaled);
  EXPECT_EQ(contradicted(constants), Names{"gyro scale"});
  EXPECT_EQ(constant(constants, "gyro scale").advice, "thermorig calibrate scale");
  EXPECT_NEAR(constant(constants, "gyro scale").session->value, sound.profile.gyro.scale, 0.005);

  auto filtered = sound;
  filtered.world.gyro.bandwidth_hz = 20.0;
  constants = checked(filtered);
  EXPECT_EQ(contradicted(constants), Names{"gyro filter delay"});
  EXPECT_NEAR(constant(constants, "gyro filter delay").session->value, 0.225 / 20.0, 0.004);
  EXPECT_THAT(constant(constants, "gyro filter delay").advice, HasSubstr("bandwidth_hz"));

  auto late = sound;
  late.world.camera.extra_latency_ms = 12.0;
  constants = checked(late);
  EXPECT_EQ(contradicted(constants), Names{"camera latency"});
  const CheckedConstant latency = constant(constants, "camera latency");
  EXPECT_NEAR(latency.session->value - latency.profile->value, 0.012, 0.003);
  EXPECT_EQ(latency.advice, "thermorig calibrate latency");
  EXPECT_THAT(latency.why, HasSubstr("later"));

  auto weak = sound;
  weak.world.servo.top_speed_dps = 180.0;
  constants = checked(weak);
  EXPECT_EQ(contradicted(constants), (Names{"servo at -200 deg/s", "servo at +200 deg/s"}));
  EXPECT_NEAR(constant(constants, "servo at +200 deg/s").session->value, 180.0, 3.0);
  EXPECT_THAT(constant(constants, "servo at +200 deg/s").why, HasSubstr("weak supply, load or servo"));
  EXPECT_EQ(constant(constants, "servo at +75 deg/s").verdict, ConstantVerdict::holds);
}

TEST(CheckConstants, WithoutAWholeTurnTheScaleIsNotChecked) {
  const auto constants = checked(calibrated_rig(3, "180"));
  const CheckedConstant& scale = constant(constants, "gyro scale");
  EXPECT_EQ(scale.verdict, ConstantVerdict::not_checked);
  EXPECT_THAT(scale.why, HasSubstr("no turn closes"));
  EXPECT_EQ(scale.advice, "thermorig calibrate scale");
  EXPECT_FALSE(scale.session);
}

TEST(CheckConstants, WhatWasNeverMeasuredIsSaidToBeAnAssumption) {
  const auto constants = checked(rig_with(1));
  EXPECT_FALSE(is_contradicted(constants));
  for (const char* name : {"gyro scale", "gyro bias", "camera latency", "servo scale"}) {
    EXPECT_EQ(constant(constants, name).verdict, ConstantVerdict::not_checked) << name;
    EXPECT_THAT(constant(constants, name).why, HasSubstr("never measured")) << name;
    EXPECT_THAT(constant(constants, name).advice, HasSubstr("thermorig calibrate")) << name;
    EXPECT_TRUE(constant(constants, name).session) << name;
  }
}

/// A session in which only the servo's clock was heard, through `length_s`.
session::Session with_servo_clock(double needed_ppm, double bound_ppm, double length_s) {
  session::Session session;
  session.raw.header.profile.servo.link.wander_ppm = 6.0;
  ClockReport& clock = session.sync.clock[Device::servo];
  clock.method = "two-way";
  clock.needed_wander_ppm = needed_ppm;
  clock.bound_wander_ppm = bound_ppm;
  clock.epochs.resize(1);
  for (const double share : {0.0, 0.5, 1.0}) clock.knots.push_back({HostTime(from_s(share * length_s))});
  return session;
}

CheckedConstant servo_clock(const session::Session& session) {
  return constant(check_constants(session), "servo clock wander");
}

TEST(CheckConstants, AServoClockHoldsWhereAnswersTellThatItIsAsGoodAsItsProfileSays) {
  EXPECT_EQ(servo_clock(with_servo_clock(6.0, 6.0, 300.0)).verdict, ConstantVerdict::holds);
}

TEST(CheckConstants, AServoClockThatNeedsMoreThanItsProfileSaysContradictsHoweverShortItWasHeard) {
  for (const double length_s : {15.0, 300.0}) {
    const CheckedConstant clock = servo_clock(with_servo_clock(48.0, 96.0, length_s));
    EXPECT_EQ(clock.verdict, ConstantVerdict::contradicts);
    EXPECT_EQ(clock.session->value, 48.0);
    EXPECT_THAT(clock.advice, HasSubstr("wander_ppm in [servo]"));
  }
  EXPECT_EQ(servo_clock(with_servo_clock(std::numeric_limits<double>::infinity(), 0.0, 300.0)).verdict,
            ConstantVerdict::contradicts);
}

TEST(CheckConstants, AServoClockIsNotCheckedWhereItsWanderCouldNotHaveBeenTold) {
  const CheckedConstant slow = servo_clock(with_servo_clock(6.0, 96.0, 300.0));
  EXPECT_EQ(slow.verdict, ConstantVerdict::not_checked);
  EXPECT_THAT(slow.why, HasSubstr("96 ppm"));
  const CheckedConstant brief = servo_clock(with_servo_clock(6.0, 6.0, 20.0));
  EXPECT_EQ(brief.verdict, ConstantVerdict::not_checked);
  EXPECT_THAT(brief.why, HasSubstr("session too short"));
}

/// The host's clock is slewed by 500 ppm from the begin to the end: nothing in these 25 s tells it.
TEST(CheckConstants, WhatSoShortASessionCannotTellOfAClockIsNotChecked) {
  auto config = rig_with(2);
  config.world.links.host_slew_ppm = 500.0;
  const CheckedConstant clock = constant(checked(config), "servo clock wander");
  EXPECT_EQ(clock.verdict, ConstantVerdict::not_checked) << text(clock);
  EXPECT_THAT(clock.why, HasSubstr("session too short"));
}

TEST(CheckConstants, AnEmptySessionChecksNothing) {
  for (const CheckedConstant& one : check_constants(session::Session()))
    EXPECT_EQ(one.verdict, ConstantVerdict::not_checked) << text(one);
}

}  // namespace
}  // namespace thermorig::calibration
