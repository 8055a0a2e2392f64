// SPDX-License-Identifier: MIT
#include "thermorig/rig/sweep/step_queue.h"

#include <gtest/gtest.h>

#include "support/at_s.h"

namespace thermorig::rig::test {
namespace {

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

}  // namespace
}  // namespace thermorig::rig::test
