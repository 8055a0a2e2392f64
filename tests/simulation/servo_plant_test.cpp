// SPDX-License-Identifier: MIT
#include "simulation/servo_plant.h"

#include <gtest/gtest.h>

#include "driven_plant.h"
#include "frame_statistics.h"

namespace thermorig::simulation {
namespace {

TEST(ServoPlant, StepsToTheCommandedAngleWithoutMuchOvershoot) {
  ServoPlant plant(winch(), 8.0, 1);
  drive(
      plant, [](double) { return width_of(0.0); }, 1.0);
  const double from_deg = plant.angle_deg();
  const Motion motion = drive(
      plant, [](double) { return width_of(20.0); }, 1.0);
  const double way_deg = plant.angle_deg() - from_deg;
  EXPECT_NEAR(way_deg, 20.0, 1.5);
  EXPECT_LT(motion.angle_at(0.01) - from_deg, 0.2 * way_deg);
  EXPECT_GT(motion.angle_at(0.12) - from_deg, 0.8 * way_deg);
  EXPECT_LT(quantile_of(motion.angle_deg, 1.0) - from_deg, 1.1 * way_deg);
}

TEST(ServoPlant, FollowsASweepWithItsMeanSpeedAndTheRippleOfItsPulses) {
  ServoPlant plant(winch(), 8.0, 1);
  const Motion motion = drive(
      plant, [](double time_s) { return width_of(-800.0 + 200.0 * time_s); }, 6.0);
  const auto rates = motion.rates_between(3.0, 6.0);
  EXPECT_NEAR((motion.angle_at(5.99) - motion.angle_at(3.0)) / 2.99, 200.0, 8.0);
  EXPECT_GT(deviation_of(rates), 6.5);  // 7.6 deg/s rms for a loop of 8 Hz and pulses every 20 ms
  EXPECT_LT(deviation_of(rates), 8.7);
}

TEST(ServoPlant, RipplesMoreWithAStifferLoop) {
  const auto ripple = [](double loop_hz) {
    ServoPlant plant(winch(), loop_hz, 1);
    return deviation_of(drive(
                            plant, [](double time_s) { return width_of(-800.0 + 200.0 * time_s); }, 5.0)
                            .rates_between(3.0, 5.0));
  };
  EXPECT_LT(ripple(5.0), 4.0);
  EXPECT_GT(ripple(15.0), 20.0);
}

TEST(ServoPlant, LagsBehindASweep) {
  ServoPlant plant(winch(), 8.0, 2);
  ServoPlant slow(winch(), 8.0, 2);
  const auto sweep = [](double rate_dps) {
    return [rate_dps](double time_s) { return width_of(-300.0 + rate_dps * time_s); };
  };
  const double fast_deg = drive(plant, sweep(200.0), 3.0).angle_deg.back();
  const double slow_deg = drive(
                              slow, [](double) { return width_of(300.0); }, 3.0)
                              .angle_deg.back();
  const double lag_s = (slow_deg - fast_deg) / 200.0;
  EXPECT_GT(lag_s, 0.02);
  EXPECT_LT(lag_s, 0.10);
}

TEST(ServoPlant, NeverExceedsItsTopSpeed) {
  ServoPlant plant(winch(), 8.0, 3);
  const Motion motion = drive(
      plant, [](double) { return width_of(900.0); }, 4.0);
  const double top_dps = quantile_of(motion.rate_dps, 1.0);
  EXPECT_GT(top_dps, 370.0);
  EXPECT_LE(top_dps, 600.0);
}

TEST(ServoPlant, IgnoresCommandsWithinItsDeadBand) {
  ServoPlant plant(winch(), 8.0, 4);
  drive(
      plant, [](double) { return width_of(10.0); }, 2.0);
  const double before_deg = plant.angle_deg();
  drive(
      plant, [](double) { return width_of(10.02); }, 1.0);
  EXPECT_NEAR(plant.angle_deg(), before_deg, 0.03);
}

TEST(ServoPlant, StaysWhereItIsWithoutPulses) {
  ServoPlant plant(winch(), 8.0, 5);
  const Motion motion = drive(
      plant, [](double time_s) { return time_s < 1.0 ? width_of(200.0 * time_s) : 0.0; }, 3.0);
  EXPECT_NEAR(motion.rate_at(2.0), 0.0, 1e-3);
  EXPECT_NEAR(motion.angle_at(2.9), motion.angle_at(1.5), 0.05);
  EXPECT_GT(motion.angle_at(2.9), 100.0);
}

TEST(ServoPlant, DoesNotMoveBeforeItsFirstPulse) {
  ServoPlant plant(winch(), 8.0, 6);
  const double start_deg = plant.angle_deg();
  drive(
      plant, [](double) { return 0.0; }, 1.0);
  EXPECT_EQ(plant.angle_deg(), start_deg);
}

TEST(ServoPlant, OfOneHundredAndEightyDegreesSpansThem) {
  ServoProfile servo;
  servo.travel_deg = 180.0;
  ServoPlant plant(servo, 8.0, 7);
  drive(
      plant, [](double) { return 500.0; }, 2.0);
  const double low_deg = plant.angle_deg();
  drive(
      plant, [](double) { return 2500.0; }, 2.0);
  EXPECT_NEAR(plant.angle_deg() - low_deg, 180.0, 8.0);
}

TEST(ServoPlant, WithContinuousRotationTurnsThePulseIntoSpeedAndCoastsWithout) {
  ServoProfile servo;
  servo.kind = ServoKind::continuous;
  servo.full_rate_dps = 240.0;
  ServoPlant plant(servo, 8.0, 8);
  const Motion motion = drive(
      plant, [](double time_s) { return time_s < 1.0   ? 1500.0
                                        : time_s < 3.0 ? 2000.0
                                                       : 0.0; }, 4.0);
  EXPECT_EQ(motion.rate_at(0.9), 0.0);
  EXPECT_NEAR(motion.rate_at(2.9), 120.0, 6.0);
  EXPECT_GT(motion.rate_at(3.1), 20.0);
  EXPECT_LT(motion.rate_at(3.99), 2.0);
}

}  // namespace
}  // namespace thermorig::simulation
