// SPDX-License-Identifier: MIT
// A continuous servo whose cable bears a turn and a half, and a plan that only ever turns one way.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "servo_link.h"
#include "simulated_bus.h"
#include "thermorig/rig/recording/finalise.h"
#include "thermorig/rig/sweep/servo_commander.h"

namespace thermorig::rig::test {
namespace {

TEST(CableGuard, LetsASweepUnwindBeforeALegThatWouldNotFit) {
  const TemporaryFolder folder;
  auto config = simulation::default_rig(8, "kitchen");
  config.profile.servo.kind = ServoKind::continuous;
  config.profile.servo.full_rate_dps = 220.0;
  config.profile.servo.travel_deg = 544.0;
  SimulatedBus bus(config);
  SweepPlan plan = short_plan();
  plan.leg_rates_dps = std::vector<double>(6, 80.0);
  const DrivenRun run = run_to_journal(bus, recording_options(folder, config.profile, plan));
  ASSERT_FALSE(run.failure) << run.failure->what();
  const session::Session session = build_session(run.raw);
  ASSERT_FALSE(session.servo.empty());
  double turned_deg = 0.0;
  for (const TimedServo& servo : session.servo) {
    EXPECT_LE(std::abs(servo.state.angle_deg), 270.0);
    EXPECT_NE(servo.state.fault, ServoFault::limit);
    if (servo.state.rate_dps > 79.0) turned_deg += 0.01 * servo.state.rate_dps;
  }
  EXPECT_GT(turned_deg, 544.0);  // more than fits without unwinding
}

TEST(CableGuard, IsMissedWhereTheFirmwareHasNone) {
  ServoProfile servo;
  servo.kind = ServoKind::continuous;
  servo.full_rate_dps = 220.0;
  const auto greeted_by = [&servo](const std::string& firmware) {
    ServoCommander commander(servo);
    commander.greet();
    commander.poll(HostTime{});
    commander.answer(
        {.body = wire::ServoWelcome{.version = SERVO_LINK_VERSION, .firmware = firmware}, .sequence = 0},
        HostTime{});
    return commander.greeted();
  };
  EXPECT_TRUE(greeted_by("1.2.0"));
  EXPECT_TRUE(greeted_by("2.0.0"));
  try {
    greeted_by("1.1.0");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what_happened(), testing::HasSubstr("does not guard the cable"));
    EXPECT_THAT(error.advice(), testing::HasSubstr("reflash"));
  }
  servo.travel_deg = 0.0;
  EXPECT_TRUE(greeted_by("1.1.0"));
}

}  // namespace
}  // namespace thermorig::rig::test
