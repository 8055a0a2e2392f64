// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "network/loss.h"

namespace thermorig::network {
namespace {

struct Slopes {
  StepLoss loss;
  std::array<float, 2> thermal{}, gain{};
};

/// Of two windows: one that is right, one that is off by `error`.
Slopes slopes_of(float error, float gain, float gyro = 0.0F) {
  const std::array<float, 2> thermal{0.25F, 0.25F + error}, gains{gain, gain}, gyros{gyro, gyro},
      label{0.25F, 0.25F};
  Slopes slopes;
  slopes.loss = loss_of({thermal, gains, gyros, label}, {.likelihood = true}, slopes.thermal, slopes.gain);
  return slopes;
}

TEST(Likelihood, TakesKgForTheSigmaThatIsBestBesideAGyroOfTenDegreesASecond) {
  EXPECT_NEAR(gate_sigma(0.5, 10.0), 10.0, 1e-9);
  EXPECT_NEAR(gate_sigma(0.8, 10.0), 5.0, 1e-9);  // 100 / (100 + 25)
  EXPECT_GT(gate_sigma(0.0, 10.0), 1e4);
  EXPECT_GT(gate_sigma(1.0, 10.0), 0.0);
}

TEST(Likelihood, LeavesTheGateAloneWhereItStatesTheErrorThatThereIs) {
  const auto error = static_cast<float>(gate_sigma(0.7, gate_gyro_sigma));
  EXPECT_NEAR(slopes_of(error, 0.7F).gain[1], 0.0F, 1e-6F);
  EXPECT_GT(slopes_of(2.0F * error, 0.7F).gain[1], 0.0F);  // too sure: Kg falls
  EXPECT_LT(slopes_of(0.5F * error, 0.7F).gain[1], 0.0F);
}

TEST(Likelihood, WeighsAnErrorByTheSigmaThatIsStated) {
  const Slopes sure = slopes_of(0.1F, 0.8F), unsure = slopes_of(0.1F, 0.5F);
  EXPECT_NEAR(sure.thermal[1], 2.0F * unsure.thermal[1], 1e-5F);
  EXPECT_EQ(sure.thermal[0], 0.0F);
}

TEST(Likelihood, NeverAsksTheGyro) {
  const Slopes one = slopes_of(0.1F, 0.6F, 0.0F), other = slopes_of(0.1F, 0.6F, 0.9F);
  EXPECT_EQ(one.thermal, other.thermal);
  EXPECT_EQ(one.gain, other.gain);
  EXPECT_EQ(one.loss.loss, other.loss.loss);
  EXPECT_NE(one.loss.squared_error, other.loss.squared_error);
}

TEST(Likelihood, StaysFiniteWhereTheGateIsWideOpenOrShut) {
  for (const float gain : {0.0F, 1.0F}) {
    const Slopes slopes = slopes_of(1.0F, gain);
    EXPECT_TRUE(std::isfinite(slopes.loss.loss) && std::isfinite(slopes.thermal[1]));
    EXPECT_LE(std::abs(slopes.gain[1]), 1.0F);
  }
}

}  // namespace
}  // namespace thermorig::network
