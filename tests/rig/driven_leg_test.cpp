// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/at_s.h"
#include "test_servos.h"
#include "thermorig/rig/sweep/driven_leg.h"
#include "thermorig/rig/sweep/plan.h"
#include "thermorig/rig/sweep/quota.h"

namespace thermorig::rig::test {

namespace {

/// Frames at 1, 2, 3, 4 s; telemetry until `heard_s`.
DrivenLeg driven(double heard_s) {
  DrivenLeg leg(LegRecord{.leg = 1}, 4, false);
  leg.acknowledge(at_s(0.0));
  leg.seen(at_s(0.1));
  for (int i = 1; i <= 4; ++i) leg.frame(at_s(i), at_s(i + 0.1), from_s(0.0));
  leg.seen(at_s(heard_s));
  return leg;
}

TEST(DrivenLeg, IsWholeWithTheFramesThatWerePlanned) {
  const DrivenLeg leg = driven(4.5);
  EXPECT_TRUE(leg.is_whole());
  EXPECT_EQ(leg.closed(at_s(5.0)).end, at_s(4.1));
}

TEST(DrivenLeg, ThatBrokeOffHasNoFramesBehindItsLastTelemetry) {
  DrivenLeg leg = driven(2.5);
  leg.broke_off();
  EXPECT_FALSE(leg.is_whole());
  EXPECT_EQ(leg.record().frames, 2U);
  EXPECT_EQ(leg.closed(at_s(5.0)).end, at_s(2.1));
}

TEST(DrivenLeg, ThatBrokeOffBehindItsLastFrameStaysWhole) {
  DrivenLeg leg = driven(4.5);
  leg.broke_off();
  EXPECT_TRUE(leg.is_whole());
}

TEST(DrivenLeg, GivesBackAFrameOfTheLegAfterIt) {
  DrivenLeg leg = driven(4.5);
  leg.take_back();
  EXPECT_EQ(leg.record().frames, 3U);
  EXPECT_EQ(leg.closed(at_s(5.0)).end, at_s(3.1));
}

/// Three of four frames have come when it is left, halfway to the fourth.
LeftLeg left_before_its_last() {
  DrivenLeg leg(LegRecord{.leg = 1}, 4, false);
  leg.seen(at_s(0.1));
  for (int i = 1; i <= 3; ++i) leg.frame(at_s(i), at_s(i + 0.1), from_s(0.0));
  return {leg, at_s(4.5)};
}
constexpr HostDuration frame_delay = std::chrono::milliseconds(100);

TEST(LeftLeg, IsSettledWithItsLastFrame) {
  LeftLeg leg = left_before_its_last();
  EXPECT_FALSE(leg.is_settled());
  leg.frame(at_s(4.0), at_s(4.1), from_s(0.0), frame_delay);
  EXPECT_TRUE(leg.is_settled());
  EXPECT_TRUE(leg.settled().is_whole());
}

TEST(LeftLeg, LacksAFrameThatTheOneAfterWasTakenFor) {
  LeftLeg leg = left_before_its_last();
  leg.frame(at_s(4.4), at_s(4.7), from_s(0.0), frame_delay);
  EXPECT_FALSE(leg.is_settled());
  EXPECT_EQ(leg.settled().record().frames, 3);
}

TEST(LeftLeg, BelievesALateLastFrameIfOneMoreComes) {
  LeftLeg leg = left_before_its_last();
  leg.frame(at_s(4.4), at_s(4.7), from_s(0.0), frame_delay);
  leg.frame(at_s(5.0), at_s(5.1), from_s(0.0), frame_delay);
  EXPECT_TRUE(leg.is_settled());
  EXPECT_TRUE(leg.settled().is_whole());
}

/// A travel of 200 degrees to either side of the middle.
ServoProfile servo_of_400() {
  ServoProfile servo = servo_of(400.0);
  servo.stop_margin_deg = 0.0;
  servo.acceleration_dps2 = 1000.0;
  return servo;
}

TEST(ServoTravel, ALegCoversAtMostTheWayFromEndToEnd) {
  const ServoTravel travel(servo_of_400());
  EXPECT_LT(travel.way_deg(100.0, 12, 8.0), 400.0);
  EXPECT_EQ(travel.way_deg(100.0, 57, 8.0), 400.0);
  EXPECT_FALSE(travel.is_too_short_for(100.0, 12, 8.0));
  EXPECT_TRUE(travel.is_too_short_for(100.0, 57, 8.0));
}

TEST(ServoTravel, AContinuousServoHasNoEnd) {
  const ServoTravel travel(continuous_servo());
  EXPECT_FALSE(travel.is_too_short_for(100.0, 5000, 8.0));
  EXPECT_EQ(travel.frames_left(100.0, 1e6, 8.0, 57), 57);
}

TEST(ServoTravel, ALegLiesEvenAboutTheMiddleInItsDirection) {
  EXPECT_EQ(ServoTravel::start_deg(30.0, 100.0), -50.0);
  EXPECT_EQ(ServoTravel::start_deg(-30.0, 100.0), 50.0);
}

TEST(ServoTravel, HasRoomForALegThatEndsBeforeItsEnd) {
  const ServoTravel travel(servo_of_400());
  EXPECT_TRUE(travel.has_room(30.0, 300.0, -100.0));
  EXPECT_FALSE(travel.has_room(-30.0, 300.0, -100.0));
  EXPECT_FALSE(travel.has_room(30.0, 300.03, -100.0));
  EXPECT_TRUE(travel.has_room(30.0, 300.03, -100.0, 0.05));
}

TEST(ServoTravel, LeavesRoomForTheCommandAndTheBraking) {
  const ServoTravel travel(servo_of_400());
  // 200 - 100 deg ahead, 5 of them to brake: 0.95 s at 100 deg/s, a quarter second of it until the command.
  EXPECT_EQ(travel.frames_left(100.0, 100.0, 10.0, 57), 6);
  EXPECT_EQ(travel.frames_left(-100.0, -100.0, 10.0, 57), 6);
  EXPECT_EQ(travel.frames_left(100.0, 190.0, 10.0, 57), 0);
  EXPECT_EQ(travel.frames_left(100.0, -200.0, 10.0, 4), 4);
}

SweepPlan three_steps(int valid_per_leg) {
  return {.name = "test", .leg_rates_dps = {30.0, -30.0, 60.0}, .valid_per_leg = valid_per_leg};
}

TEST(StepQueue, DrivesAStepAgainAfterTheOneUnderWay) {
  StepQueue steps(three_steps(0));
  steps.finish_front(0, at_s(1.0));
  steps.drive_again({.index = 0, .was_short = true});
  EXPECT_EQ(steps.number(), 2);
  EXPECT_TRUE(steps.is_driven_again(0));
  steps.finish_front(0, at_s(2.0));
  EXPECT_EQ(steps.number(), 1);
  EXPECT_TRUE(steps.front().was_short);
  EXPECT_EQ(steps.rate_dps_at(1), 60.0);
}

TEST(StepQueue, WithoutAStepLeftDrivesOneAgainAtOnce) {
  StepQueue steps(three_steps(0));
  while (!steps.empty()) steps.finish_front(0, at_s(1.0));
  EXPECT_EQ(steps.number(), 3);
  EXPECT_EQ(steps.rate_dps(), 0.0);
  steps.drive_again({.index = 1});
  EXPECT_EQ(steps.rate_dps(), -30.0);
}

TEST(StepQueue, LooksAtAStepAgainOnceItsLabelsAreThere) {
  StepQueue steps(three_steps(10));
  steps.finish_front(57, at_s(1.0));
  EXPECT_FALSE(steps.take_labelled(56, at_s(2.0)));
  EXPECT_TRUE(steps.awaits_labels());
  EXPECT_EQ(steps.take_labelled(57, at_s(2.0)), 0U);
  EXPECT_FALSE(steps.awaits_labels());
}

TEST(StepQueue, LooksAtAStepAgainWhoseLabelsDoNotCome) {
  StepQueue steps(three_steps(10));
  steps.finish_front(57, at_s(1.0));
  EXPECT_FALSE(steps.take_labelled(0, at_s(4.0)));
  EXPECT_EQ(steps.take_labelled(0, at_s(4.1)), 0U);
}

TEST(StepQueue, WithoutAQuotaLooksAtNone) {
  StepQueue steps(three_steps(0));
  steps.finish_front(0, at_s(1.0));
  EXPECT_FALSE(steps.awaits_labels());
}

TEST(StepQueue, TellsThePlanThatIsLeft) {
  StepQueue steps(three_steps(0));
  steps.finish_front(0, at_s(1.0));
  EXPECT_EQ(steps.plan_left().leg_rates_dps, (std::vector{-30.0, 60.0}));
  steps.clear();
  EXPECT_TRUE(steps.plan_left().leg_rates_dps.empty());
}

constexpr double frame_rate_hz = 8.0;

/// One step of 12 frames, of which 6 are to be valid, and its first leg.
struct OneStep {
  OneStep() { quota.begin(leg.record()); }
  void drive(int frames, bool valid) {
    for (int i = 0; i < frames; ++i) {
      quota.frame();
      LabelledSample sample;
      sample.leg = 1;
      sample.rate_shaft_dps = 30.0F;
      sample.valid = valid;
      quota.sample(sample);
    }
  }
  DrivenLeg leg{LegRecord{.leg = 1, .step = 0, .rate_dps = 30.0}, 12, false};
  StepQuota quota{
      {.leg_rates_dps = {30.0}, .frames_per_leg = 12, .valid_per_leg = 6}, servo_of(2160.0), frame_rate_hz};
};

TEST(StepQuota, MissesWhatIsNotValidYet) {
  OneStep step;
  EXPECT_EQ(step.quota.missing(0), 6);
  step.drive(4, true);
  step.drive(3, false);
  EXPECT_EQ(step.quota.missing(0), 2);
  EXPECT_EQ(step.quota.samples(), 7U);
}

TEST(StepQuota, ALegHasItsLabelsWithTheFramesThatAreOnTheirWay) {
  OneStep step;
  step.drive(4, true);
  step.quota.frame();
  EXPECT_EQ(step.quota.samples_with(step.leg), 5U + 12U);
}

TEST(StepQuota, WantsMoreFramesThanThoseThatAreAwaited) {
  OneStep step;
  EXPECT_LE(step.quota.frames_wanted(step.leg, frame_rate_hz), 0) << "the 12 frames to come will do";
  const DrivenLeg driven(LegRecord{.leg = 1, .step = 0, .rate_dps = 30.0, .frames = 12}, 12, false);
  step.drive(12, false);
  EXPECT_EQ(step.quota.frames_wanted(driven, frame_rate_hz), 6 + 1);
}

TEST(StepQuota, GivesAStepUpOnceWhenNoneOfTheLatestFramesIsValid) {
  OneStep step;
  step.drive(23, false);
  EXPECT_FALSE(step.quota.give_up(0, 12));
  step.drive(1, false);
  const auto why = step.quota.give_up(0, 13);
  ASSERT_TRUE(why);
  EXPECT_THAT(*why, ::testing::HasSubstr("step 1 of 1 (+30 deg/s): still 6 valid frames short after 13"));
  EXPECT_TRUE(step.quota.is_given_up(0));
  EXPECT_FALSE(step.quota.give_up(0, 14)) << "it was said";
}

TEST(StepQuota, CountsTheFramesOfEarlierLegsOfTheStep) {
  OneStep step;
  step.drive(1, true);
  step.quota.ended({.leg = 1, .step = 0, .frames = 59});
  step.drive(1, true);
  EXPECT_FALSE(step.quota.give_up(0, -59)) << "none but the one before";
  EXPECT_TRUE(step.quota.give_up(0, 1)) << "60 frames are five times those of the plan";
}

}  // namespace

}  // namespace thermorig::rig::test
