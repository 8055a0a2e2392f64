// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/labels/running_bias.h"

#include <gtest/gtest.h>

#include <cmath>

#include "scripted_rig.h"

namespace thermorig::labels {
namespace {

GyroMean rest(double rate_dps, double deviation_dps = 0.07) {
  return {.rate_dps = rate_dps, .count = 50, .deviation_dps = deviation_dps};
}

TEST(RunningBias, IsTheProfilesUntilRestsTell) {
  GyroProfile profile;
  profile.bias_dps = 1.5;
  profile.bias_uncertainty_dps = 7.0;
  RunningBias bias(assumed_gyro_errors(profile));
  bias.add(rest(3.0));
  EXPECT_EQ(bias.errors().bias_dps, (Estimate{1.5, 7.0}));
  for (int i = 0; i < 4; ++i) bias.add(rest(3.0 + 0.01 * i));
  EXPECT_NEAR(bias.errors().bias_dps->value, 3.01, 0.02);
  EXPECT_LT(bias.errors().bias_dps->uncertainty, 0.1);
  EXPECT_NEAR(bias.errors().noise_dps, 0.07, 1e-9);
}

TEST(RunningBias, IsNotMovedByAHandThatTurnsTheRigForAWhile) {
  RunningBias bias(assumed_gyro_errors({}));
  for (int i = 0; i < 20; ++i) bias.add(rest(2.0));
  for (int i = 0; i < 12; ++i) bias.add(rest(36.0, 1.0));
  EXPECT_NEAR(bias.errors().bias_dps->value, 2.0, 1e-9);
}

TEST(RunningBias, NothingButZerosSayNothing) {
  RunningBias bias(assumed_gyro_errors({}));
  for (int i = 0; i < 20; ++i) bias.add(rest(0.0, 0.0));
  EXPECT_EQ(bias.errors().bias_dps->uncertainty, GyroProfile{}.bias_uncertainty_dps);
}

TEST(RunningBias, LetsALiveLabellerSeeThatTheGyroDisagrees) {
  ScriptedRig rig;  // 3 s of rest, then a leg that the shaft does not follow
  rig.rate_dps = [](double t) { return t < 3.0 ? 0.0 : 100.0; };
  rig.motion = [](double t) { return t < 3.0 ? ServoMotion::holding : ServoMotion::steady; };
  rig.gyro_dps = [](double t) { return t < 3.0 ? 5.0 : 5.0 + 80.0; };
  const auto samples = rig.run(5.0);
  EXPECT_TRUE(has(samples.at(32), Reason::gyro_disagrees));
  rig.gyro_dps = [](double t) { return t < 3.0 ? 5.0 : 5.0 + 101.0; };
  EXPECT_FALSE(has(rig.run(5.0).at(32), Reason::gyro_disagrees));
}

}  // namespace
}  // namespace thermorig::labels
