// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/labels/servo_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "thermorig/core/sync.h"

namespace thermorig::labels {
namespace {

constexpr auto nothing = [](double) {};

TEST(ServoLoop, IsTheSecondOrderStepResponse) {
  ServoLoop loop(false, 8.0, 0.0);
  loop.restart(0.0, 0.0);
  const double natural = 2.0 * std::numbers::pi * 8.0, swing = natural * std::sqrt(1.0 - 0.49);
  double time = 0.0;
  for (const double step_s : {0.013, 0.02, 0.0071, 0.05}) {
    loop.advance(10.0, step_s, nothing);
    time += step_s;
    const double decay = std::exp(-0.7 * natural * time);
    const double expected =
        10.0 * (1.0 - decay * (std::cos(swing * time) + 0.7 * natural / swing * std::sin(swing * time)));
    EXPECT_NEAR(loop.angle_deg(), expected, 1e-9) << time;
  }
}

TEST(ServoLoop, AContinuousOneFollowsTheRateAsAFirstOrderLag) {
  ServoLoop loop(true, 5.0, 0.0);
  loop.restart(0.0, 0.0);
  loop.advance(100.0, 0.1, nothing);
  const double rad = 2.0 * std::numbers::pi * 5.0;
  EXPECT_NEAR(loop.rate_dps(), 100.0 * (1.0 - std::exp(-0.1 * rad)), 1e-9);
  EXPECT_NEAR(loop.angle_deg(), 100.0 * (0.1 - (1.0 - std::exp(-0.1 * rad)) / rad), 1e-9);
}

TEST(ServoLoop, StopsHalfADeadBandShortOfItsGoal) {
  ServoLoop loop(false, 8.0, 0.4);
  loop.restart(0.0, 0.0);
  loop.advance(0.15, 1.0, nothing);
  EXPECT_EQ(loop.angle_deg(), 0.0);
  for (int i = 0; i < 40; ++i) loop.advance(5.0, 0.05, nothing);
  EXPECT_GE(loop.angle_deg(), 4.8 - 1e-3);
  EXPECT_LE(loop.angle_deg(), 5.2);
}

TEST(ServoLoop, RestartedInMotionItGoesOn) {
  ServoLoop loop(false, 8.0, 0.0);
  loop.restart(50.0, 100.0);
  const double begin_deg = loop.angle_deg();
  double angle = 50.0;
  for (int i = 0; i < 10; ++i, angle += 2.0) loop.advance(angle, 0.02, nothing);
  EXPECT_NEAR(loop.angle_deg() - begin_deg, 20.0, 0.2);
}

TEST(SettlingTime, LeavesOnePercentOfAStep) {
  for (const double loop_hz : {3.0, 8.0, 20.0}) {
    ServoResponse response;
    response.loop_hz = loop_hz;
    response.delay_s = 0.0;
    ServoLoop loop(false, loop_hz, 0.0);
    loop.restart(0.0, 0.0);
    double angle = 0.0;
    for (double time = 0.0; time < settle_s(response); time += 0.001, angle += 0.1)
      loop.advance(angle, 0.001, nothing);
    EXPECT_NEAR(loop.rate_dps(), 100.0, 1.5) << loop_hz;
  }
}

}  // namespace
}  // namespace thermorig::labels
