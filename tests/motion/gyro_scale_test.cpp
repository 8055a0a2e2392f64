// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "thermorig/fit/motion/panorama_fit.h"
#include "turning_rig.h"

namespace thermorig::motion {
namespace {

TurnResult scale_of(const Turning& turning) {
  return gyro_scale(turning.frames, turning.gyro, {}, turning.errors);
}

void expect_scale(const Turning& turning, unsigned seed) {
  const TurnResult found = scale_of(turning);
  ASSERT_TRUE(found.gyro_scale) << seed << ": " << found.why_not;
  EXPECT_NEAR(found.gyro_scale->value, turning.true_scale, 0.003) << seed;
  EXPECT_NEAR(found.gyro_scale->value, turning.true_scale, 4.0 * found.gyro_scale->uncertainty) << seed;
  EXPECT_LT(found.gyro_scale->uncertainty, 0.003) << seed;
  EXPECT_GT(found.turned_deg, 340.0);
}

TEST(GyroScale, IsKnownFromAServoThatTurnsMoreThanOnce) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    auto config = simulation::default_rig(seed, environment_of(seed));
    config.gyro_grade = seed % 2 == 0 ? simulation::GyroGrade::mpu6050_raw : simulation::GyroGrade::typical;
    expect_scale(turn(config, back_and_forth(90.0, 5.0, 62.0), 62.0), seed);
  }
}

TEST(GyroScale, IsKnownFromOneTurnByHandBetweenRests) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    auto config = simulation::default_rig(seed, environment_of(seed));
    const double angle_deg = seed % 2 == 0 ? 360.0 : -366.0;
    config.hand_turns.push_back({HostTime(from_s(6.0)), 12.0, angle_deg});
    const Turning turning = turn(config, {}, 26.0);
    const TurnResult found = scale_of(turning);
    if (found.gyro_scale)
      expect_scale(turning, seed);
    else  // a bare wall where the turn closes
      EXPECT_NE(found.why_not.find("where the turn closes"), std::string::npos);
  }
}

TEST(GyroScale, OwesNothingToTheScaleThatIsAssumed) {
  Turning turning = turn(simulation::default_rig(3, "kitchen"), back_and_forth(90.0, 5.0, 62.0), 62.0);
  turning.errors.scale = {1.03, 0.03};
  expect_scale(turning, 3);
}

TEST(GyroScale, IsTheSameInWhateverOrderWindowsAreWorkedOut) {
  const Turning turning = turn(simulation::default_rig(2, "garden"), back_and_forth(90.0, 5.0, 122.0), 122.0);
  const TurnResult found = gyro_scale(turning.frames, turning.gyro, {}, turning.errors, 3,
                                      [](std::size_t count, const auto& work) {
                                        EXPECT_GT(count, 1U);
                                        for (std::size_t i = count; i-- > 0;) work(i);
                                      });
  const TurnResult in_order = gyro_scale(turning.frames, turning.gyro, {}, turning.errors, 3);
  ASSERT_TRUE(found.gyro_scale && in_order.gyro_scale);
  EXPECT_EQ(*found.gyro_scale, *in_order.gyro_scale);
  EXPECT_EQ(found.turned_deg, in_order.turned_deg);
}

double shaft_deg(const Turning& turning, HostTime time) {
  double angle_deg = 0.0;
  for (const TimedGyro& sample : turning.gyro)
    if (sample.stamp.time < time)
      angle_deg += 0.005 * (double{sample.rate_dps} - turning.errors.bias_dps->value) / turning.true_scale;
  return angle_deg;
}

/// Something hot at that angle of the shaft, which moves on by `by_deg` after 7 s.
void put_in_view(double at_deg, double by_deg, Turning& turning) {
  constexpr double pitch_deg = 55.0 / frame_columns, width_columns = 1.5, hotter_k = 15.0;
  for (TimedFrame& frame : turning.frames)
    for (std::size_t parity = 0; parity < 2; ++parity) {
      const auto [begin, end] = frame.half[parity];
      const HostTime middle = begin + (end - begin) / 2;
      const double now_deg = at_deg + (middle > HostTime(from_s(7.0)) ? by_deg : 0.0);
      const double column = 15.5 - std::remainder(now_deg - shaft_deg(turning, middle), 360.0) / pitch_deg;
      for (std::size_t i = 0; i < frame_pixels; ++i) {
        if ((i / frame_columns + i) % 2 != parity) continue;
        const double off = (static_cast<double>(i % frame_columns) - column) / width_columns;
        frame.frame.temp_c[i] += static_cast<float>(hotter_k * std::exp(-0.5 * off * off));
      }
    }
}

TEST(GyroScale, IsUncertainWhereSomethingThatMovesDrawsItFromWhereMostImagesFit) {
  for (const double by_deg : {0.0, -3.0, 3.0}) {
    Turning turning = turn(simulation::default_rig(3, "kitchen"), {{2.0, 10.5, 40.0}}, 16.0);
    put_in_view(-25.0, by_deg, turning);
    const TurnResult found = scale_of(turning);
    ASSERT_TRUE(found.gyro_scale) << by_deg << ": " << found.why_not;
    EXPECT_NEAR(found.gyro_scale->value, turning.true_scale, 2.0 * found.gyro_scale->uncertainty) << by_deg;
    EXPECT_EQ(found.gyro_scale->uncertainty > 0.005, by_deg != 0.0) << by_deg;
  }
}

/// The gyro with that bias, which it hides at rest: exactly 0 in place of what is not in one of the legs.
void hide_bias(const std::vector<Leg>& legs, double bias_dps, Turning& turning) {
  constexpr double margin_s = 1.0;
  const auto moves = [&](double time_s) {
    return std::any_of(legs.begin(), legs.end(), [&](const Leg& leg) {
      return time_s > leg.begin_s - margin_s && time_s < leg.begin_s + leg.duration_s + margin_s;
    });
  };
  for (TimedGyro& sample : turning.gyro)
    sample.rate_dps = moves(to_s(sample.stamp.time.time_since_epoch()))
                          ? sample.rate_dps + static_cast<float>(bias_dps)
                          : 0.0F;
  turning.errors.bias_dps->value += bias_dps;
  turning.errors.zeroes_itself = true;
}

TEST(GyroScale, IsNotFooledByAGyroThatHidesItsBiasAtRest) {
  const std::vector<Leg> legs{{2.0, 10.5, 40.0}, {16.5, 10.5, -40.0}};
  for (unsigned seed = 1; seed <= 4; ++seed) {
    Turning turning = turn(simulation::default_rig(seed, environment_of(seed)), legs, 32.0);
    hide_bias(legs, 4.0, turning);
    expect_scale(turning, seed);
  }
}

TEST(GyroScale, IsNotToldWhereNoTurnCloses) {
  const TurnResult found =
      scale_of(turn(simulation::default_rig(1, "garden"), back_and_forth(60.0, 3.0, 62.0), 62.0));
  EXPECT_FALSE(found.gyro_scale);
  EXPECT_NEAR(found.turned_deg, 185.0, 10.0);
  EXPECT_NE(found.why_not.find("no turn closes"), std::string::npos) << found.why_not;
}

TEST(GyroScale, IsNotToldBeforeABlindWall) {
  Turning turning = turn(simulation::default_rig(1, "laboratory"), back_and_forth(90.0, 5.0, 32.0), 32.0);
  make_wall(turning, 0.6F);
  const TurnResult found = scale_of(turning);
  EXPECT_FALSE(found.gyro_scale);
  EXPECT_NE(found.why_not.find("too little image detail"), std::string::npos) << found.why_not;
}

}  // namespace
}  // namespace thermorig::motion
