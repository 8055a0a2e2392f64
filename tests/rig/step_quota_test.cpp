// SPDX-License-Identifier: MIT
#include "thermorig/rig/sweep/step_quota.h"

#include <gmock/gmock.h>

#include "test_servos.h"

namespace thermorig::rig::test {
namespace {

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
