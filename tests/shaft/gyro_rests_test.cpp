// SPDX-License-Identifier: MIT
#include "thermorig/fit/shaft/gyro_errors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace thermorig::fit {

using namespace labels;

namespace gyro_rests {

HostTime at(double seconds) {
  return HostTime(from_s(seconds));
}

std::vector<TimedGyro> gyro_of(double seconds, const std::function<double(double)>& rate_dps) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 0.05);
  std::vector<TimedGyro> gyro;
  for (double t = 0.0; t < seconds; t += 0.005) {
    TimedGyro sample;
    sample.stamp.time = at(t);
    sample.rate_dps = static_cast<float>(rate_dps(t) + noise(random));
    sample.reading.rate_dps = {static_cast<float>(noise(random)), static_cast<float>(noise(random)),
                               sample.rate_dps};
    gyro.push_back(sample);
  }
  return gyro;
}

/// A wall with a warm edge at every 20 degrees, before a camera that turns at that rate.
std::vector<TimedFrame> frames_of(double seconds, double turning_dps) {
  std::mt19937 random(2);
  std::normal_distribution<float> noise(0.0F, 0.3F);
  std::vector<TimedFrame> frames;
  for (double t = 0.0; t < seconds; t += 0.125) {
    TimedFrame frame;
    frame.exposure_begin = at(t);
    frame.exposure_end = at(t + 0.1);
    for (std::size_t i = 0; i < frame_pixels; ++i) {
      const double azimuth_deg = static_cast<double>(i % 32) * 1.7 + turning_dps * t;
      frame.frame.temp_c[i] = static_cast<float>(20.0 + 3.0 * std::sin(azimuth_deg / 20.0)) + noise(random);
    }
    frames.push_back(frame);
  }
  return frames;
}

/// 8 s of rest, 8 s of turning, 5 s of rest.
double turned_between_rests(double t) {
  const double turning = t < 8.0 || t > 16.0 ? 0.0 : 90.0 * std::sin((t - 8.0) / 8.0 * 3.14159);
  return 1.5 + turning;
}

TEST(RestsByGyro, AreTheOpeningRestAndLaterOnes) {
  const std::vector<Interval> rests = rests_by_gyro(gyro_of(21.0, turned_between_rests));
  ASSERT_EQ(rests.size(), 2U);
  EXPECT_NEAR(rests[0].begin_s, 0.0, 0.3);
  EXPECT_NEAR(rests[0].end_s, 8.0, 0.3);
  EXPECT_NEAR(rests[0].rate_dps, 1.5, 0.05);
  EXPECT_NEAR(rests[1].begin_s, 16.0, 0.6);
}

TEST(RestsByGyro, NeedAnOpeningRestOfSomeSeconds) {
  const auto short_rest = [](double t) { return turned_between_rests(t + 4.0); };
  EXPECT_TRUE(rests_by_gyro(gyro_of(17.0, short_rest)).empty());
  EXPECT_TRUE(rests_by_gyro({}).empty());
}

TEST(RestsByGyro, AreBelievedOnlyIfTheImagesStandStill) {
  EXPECT_TRUE(are_images_still(frames_of(8.0, 0.0), at(0.0), at(8.0)));
  for (const double turning_dps : {1.0, 10.0, -40.0}) {
    SCOPED_TRACE(turning_dps);
    EXPECT_FALSE(are_images_still(frames_of(8.0, turning_dps), at(0.0), at(8.0)));
  }
}

/// A motor that turns evenly is as steady as a table.
TEST(GyroErrorsWithoutServo, TakeNoSteadyTurnForABias) {
  const auto gyro = gyro_of(8.0, [](double) { return 10.0 + 1.5; });
  EXPECT_FALSE(fit_gyro_errors_without_servo(gyro, frames_of(8.0, 10.0), GyroProfile()).bias_dps);
}

TEST(GyroErrorsWithoutServo, FollowABiasThatDriftsFromRestToRest) {
  const auto drifting = [](double t) { return turned_between_rests(t) + 0.02 * t; };
  const GyroErrors errors = fit_gyro_errors_without_servo(gyro_of(21.0, drifting), {}, GyroProfile());
  ASSERT_TRUE(errors.bias_dps);
  EXPECT_NEAR(bias_dps_at(errors, at(12.0)), 1.5 + 0.02 * 12.0, 0.05);
  EXPECT_NEAR(errors.noise_dps, 0.05, 0.01);
}

TEST(GyroErrorsWithoutServo, DoNotKnowTheBiasOfAGyroThatZeroesItself) {
  std::vector<TimedGyro> gyro = gyro_of(21.0, turned_between_rests);
  for (TimedGyro& sample : gyro)
    if (to_s(sample.stamp.time - at(0.0)) > 1.0 && to_s(sample.stamp.time - at(0.0)) < 8.0) {
      sample.rate_dps = 0.0F;
      sample.reading.rate_dps = {0.0F, 0.0F, 0.0F};
    }
  EXPECT_FALSE(fit_gyro_errors_without_servo(gyro, {}, GyroProfile()).bias_dps);
}

}  // namespace gyro_rests
}  // namespace thermorig::fit
