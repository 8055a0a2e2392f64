// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "thermorig/dataset/dataset.h"

namespace thermorig::dataset {
namespace {

using session::Session;

HostTime at(double seconds) {
  return HostTime(from_s(1000.0 + seconds));
}

/// Telemetry ten times a second and a gyro a hundred times: rest, a drive to the first angle, rest, a leg,
/// rest.
class OpeningRest : public testing::Test {
 protected:
  OpeningRest() {
    for (int i = 0; i < 200; ++i) add_servo(0.1 * i);
    for (int i = 0; i < 2000; ++i) add_gyro(0.01 * i);
  }

  void add_servo(double time_s) {
    TimedServo message;
    message.stamp.time = at(time_s);
    const bool transit = 4.0 <= time_s && time_s < 5.0, leg = 10.0 <= time_s && time_s < 15.0;
    message.state.motion = transit || leg ? ServoMotion::steady : ServoMotion::holding;
    message.state.rate_dps = transit || leg ? 100.0 : 0.0;
    message.state.leg = leg ? 1 : 0;
    session_.servo.push_back(message);
  }

  void add_gyro(double time_s) {
    TimedGyro sample;
    sample.stamp.time = at(time_s);
    const bool first_rest = 1.0 <= time_s && time_s < 4.0, second_rest = 6.0 <= time_s && time_s < 10.0;
    sample.rate_dps = first_rest ? 3.0F : second_rest ? 5.0F : 100.0F;
    session_.gyro.push_back(sample);
  }

  windows::Acquisition acquired() const { return acquisition_of(session_, "one"); }

  Session session_;
};

TEST_F(OpeningRest, TellsTheGyrosBiasBeforeTheFirstLeg) {
  EXPECT_NEAR(acquired().rest_bias_dps, (3.0 * 3.0 + 4.0 * 5.0) / 7.0, 0.02);
  EXPECT_NEAR(static_cast<double>(acquired().rest_samples), 700.0, 25.0);
}

TEST_F(OpeningRest, TakesNoSampleThatIsNoNumber) {
  session_.gyro[200].rate_dps = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NEAR(acquired().rest_bias_dps, 4.14, 0.02);
}

TEST_F(OpeningRest, IsNotKnownWithoutGyroOrWithoutTelemetry) {
  Session whole = session_;
  session_.gyro.clear();
  EXPECT_TRUE(std::isnan(acquired().rest_bias_dps));
  EXPECT_EQ(acquired().rest_samples, 0U);
  session_ = whole;
  session_.servo.clear();
  EXPECT_TRUE(std::isnan(acquired().rest_bias_dps));
}

TEST_F(OpeningRest, IsNotKnownWhereTheServoNeverStoodStill) {
  for (TimedServo& message : session_.servo) message.state.motion = ServoMotion::ramping;
  EXPECT_TRUE(std::isnan(acquired().rest_bias_dps));
}

}  // namespace
}  // namespace thermorig::dataset
