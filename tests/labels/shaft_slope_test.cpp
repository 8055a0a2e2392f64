// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/labels/servo_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace thermorig::labels {
namespace {

PulseScale scale_of(double travel_deg) {
  ServoProfile servo;
  servo.travel_deg = travel_deg;
  return PulseScale(servo);
}

TEST(ShaftSlope, IsOneWhereNothingWasFitted) {
  const ShaftSlope slope({}, {}, scale_of(200.0));
  EXPECT_EQ(slope.gain(17.0), 1.0);
  EXPECT_EQ(slope.at(17.0, true), 1.0);
  EXPECT_NEAR(slope.gained_deg(17.0), 17.0, 1e-12);
}

TEST(ShaftSlope, GainRunsStraightBetweenItsKnots) {
  const ShaftSlope slope({0.9, 1.0, 1.2}, {}, scale_of(200.0));
  EXPECT_NEAR(slope.gain(-100.0), 0.9, 1e-12);
  EXPECT_NEAR(slope.gain(-50.0), 0.95, 1e-12);
  EXPECT_NEAR(slope.gain(25.0), 1.05, 1e-12);
  EXPECT_NEAR(slope.gain(400.0), 1.2, 1e-12);
  EXPECT_TRUE(std::isfinite(slope.gain(std::numeric_limits<double>::quiet_NaN())));
}

TEST(ShaftSlope, GainedAngleIsTheIntegralOfTheGain) {
  const ShaftSlope slope({0.9, 1.0, 1.2}, {}, scale_of(200.0));
  EXPECT_NEAR(slope.gained_deg(0.0), 0.0, 1e-12);
  EXPECT_NEAR(slope.gained_deg(-100.0), -95.0, 1e-9);
  EXPECT_NEAR(slope.gained_deg(100.0), 110.0, 1e-9);
  EXPECT_NEAR(slope.gained_deg(120.0), 134.0, 1e-9);  // beyond the last knot: its gain
  EXPECT_NEAR(slope.gained_deg(-110.0), -104.0, 1e-9);
  for (const double angle_deg : {-80.0, -3.0, 40.0, 77.0}) {
    const double step_deg = 1e-4;
    const double steepness =
        (slope.gained_deg(angle_deg + step_deg) - slope.gained_deg(angle_deg)) / step_deg;
    EXPECT_NEAR(steepness, slope.gain(angle_deg), 1e-5) << angle_deg;
  }
}

TEST(ShaftSlope, RipplesRepeatOverTheAngleAndDifferByDirection) {
  const ShaftSlope slope({},
                         {{.period_deg = 40.0, .forward_cosine = 0.02, .backward_sine = 0.01},
                          {.period_deg = 360.0, .forward_sine = 0.005}},
                         scale_of(2160.0));
  EXPECT_NEAR(slope.at(0.0, true), 1.02, 1e-12);
  EXPECT_NEAR(slope.at(20.0, true), 1.0 - 0.02 + 0.005 * std::sin(M_PI / 9.0), 1e-12);
  EXPECT_NEAR(slope.at(0.0, false), 1.0, 1e-12);
  EXPECT_NEAR(slope.at(10.0, false), 1.01, 1e-12);
  EXPECT_NEAR(slope.at(-30.0, false), 1.01, 1e-12);
}

}  // namespace
}  // namespace thermorig::labels
