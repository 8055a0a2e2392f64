// SPDX-License-Identifier: MIT
// What an estimator is shown: what its entry declares, and nothing else.
#include "estimators/observer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <type_traits>

#include "hand_made.h"
#include "support/at_s.h"

namespace thermorig::estimators {
namespace {

/// A rig at rest for a second; the newest measurement is taken.
class AnEstimator : public testing::Test {
 protected:
  void SetUp() override {
    for (const Measurement& measurement : measurements_) observer_.take(measurement);
  }
  const Measurement& newest() const { return measurements_.back(); }

  std::vector<Measurement> measurements_ = measurements_of(HandMadeRig{.duration_s = 1.0});
  Observer observer_;
};

TEST_F(AnEstimator, ThatDeclaresNothingSeesTimesOnly) {
  const Observation seen = observer_.seen_with({});
  EXPECT_EQ(seen.index, measurements_.size() - 1);
  EXPECT_EQ(seen.frame.exposure_begin, newest().frame.exposure_begin);
  EXPECT_EQ(seen.frame.exposure_end, newest().frame.exposure_end);
  for (const float temp_c : seen.frame.frame.temp_c) EXPECT_TRUE(std::isnan(temp_c));
  EXPECT_TRUE(std::isnan(seen.frame.frame.sensor_temp_c));
  EXPECT_EQ(seen.frame.fresh_even, 0);  // how many pixels changed is of the image too
  EXPECT_TRUE(std::isnan(seen.gyro_mean_dps));
  EXPECT_TRUE(seen.gyro.empty());
  EXPECT_FALSE(seen.still_since);
  EXPECT_FALSE(seen.is_told_to_move);
}

TEST_F(AnEstimator, ThatDeclaresTheImageSeesItAndNoGyro) {
  const Observation seen = observer_.seen_with({.image = true});
  EXPECT_EQ(seen.frame.frame.temp_c, newest().frame.frame.temp_c);
  EXPECT_TRUE(std::isnan(seen.gyro_mean_dps));
  EXPECT_TRUE(seen.gyro.empty());
}

TEST_F(AnEstimator, IsShownImagesWithoutTheCamerasBadPixels) {
  constexpr std::size_t hot = 100;
  Measurement measurement = newest();
  for (int i = 0; i < 60; ++i) {
    for (std::size_t p = 0; p < frame_pixels; ++p)
      measurement.frame.frame.temp_c[p] = 20.0F + 0.01F * static_cast<float>((31 * i + 17 * p * p) % 97);
    measurement.frame.frame.temp_c[hot] += 60.0F;
    measurement.frame.fresh_even = measurement.frame.fresh_odd = frame_pixels / 2;
    observer_.take(measurement);
    const float seen_c = observer_.seen_with({.image = true}).frame.frame.temp_c[hot];
    EXPECT_EQ(seen_c > 30.0F, i < 23) << i;
  }
  EXPECT_EQ(observer_.seen_with({.image = true}).frame.frame.temp_c[0], measurement.frame.frame.temp_c[0]);
}

TEST_F(AnEstimator, IsNotShownWhatIsNoNumber) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  Measurement measurement = newest();
  ASSERT_GE(measurement.gyro.size(), 3U);
  measurement.gyro[0].rate_dps = nan;
  measurement.gyro[1].reading.rate_dps[2] = std::numeric_limits<float>::infinity();
  measurement.gyro[2].stamp.uncertainty_s = nan;
  observer_.take(measurement);
  EXPECT_EQ(observer_.ignored(), 3U);
  const Observation seen = observer_.seen_with({.image = true, .gyro = true});
  EXPECT_EQ(seen.gyro.size(), measurement.gyro.size() - 3);
  EXPECT_FALSE(std::isnan(seen.frame.frame.temp_c[0]));
  measurement.frame.stamp.uncertainty_s = nan;
  observer_.take(measurement);
  EXPECT_EQ(observer_.ignored(), 7U);
  const Observation blank = observer_.seen_with({.image = true});
  EXPECT_TRUE(std::isnan(blank.frame.frame.temp_c[0]));
  EXPECT_TRUE(std::isfinite(blank.frame.stamp.uncertainty_s));
  EXPECT_EQ(blank.frame.exposure_end, measurement.frame.exposure_end);
}

TEST_F(AnEstimator, ThatDeclaresTheGyroSeesItAndNoImage) {
  const Observation seen = observer_.seen_with({.gyro = true});
  EXPECT_EQ(seen.gyro.data(), newest().gyro.data());
  EXPECT_EQ(seen.gyro.size(), newest().gyro.size());
  EXPECT_EQ(seen.gyro_mean_dps, newest().sample.rate_gyro_dps);
  EXPECT_TRUE(std::isnan(seen.frame.frame.temp_c[0]));
  EXPECT_FALSE(seen.still_since);
}

TEST_F(AnEstimator, ThatDeclaresRestsSeesWhatTheServoIsTold) {
  EXPECT_EQ(observer_.seen_with({.rest = true}).still_since, at_s(0.0));
  const auto moving = measurements_of(rest_and_speed(0.5, 100.0, 0.0));
  Observer observer;
  for (const Measurement& measurement : moving) observer.take(measurement);
  EXPECT_FALSE(observer.seen_with({.rest = true}).still_since);
  EXPECT_TRUE(observer.seen_with({.rest = true}).is_told_to_move);
  EXPECT_FALSE(observer.seen_with({.image = true, .gyro = true}).is_told_to_move);
}

TEST(Labels, ReachNoEstimator) {
  const auto measurements = measurements_of(rest_and_speed(3.0, 100.0, 1.0));
  auto lies = measurements;
  for (Measurement& measurement : lies) {
    const float gyro_dps = measurement.sample.rate_gyro_dps;
    measurement.sample = LabelledSample();
    measurement.sample.rate_gyro_dps = gyro_dps;
    measurement.sample.rate_shaft_dps = measurement.sample.rate_commanded_dps = 77.0F;
    measurement.sample.angle_commanded_deg = 777.0F;
    measurement.sample.leg = 7;
    measurement.sample.run = 7;
    measurement.sample.valid = true;
    // The commanded speed is the paper's label: that it is not 0 is all that can be seen of it.
    for (TimedServo& state : measurement.servo) {
      state.state.rate_dps *= 0.3;
      state.state.angle_deg = 777.0;
      state.state.pulse_us = 777.0F;
      state.state.leg = 7;
    }
  }
  Bank honest({}, untrained_model(), {}), deceived({}, untrained_model(), {});
  const auto a = all_estimates_of(honest, measurements), b = all_estimates_of(deceived, lies);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_TRUE(are_same(a[i], b[i])) << i;
}

TEST(WhatTheServoIsTold, IsForgottenOnceItHasBeenSilent) {
  const auto measurements = measurements_of(HandMadeRig{.duration_s = 2.0});
  Observer observer;
  for (Measurement measurement : measurements) {
    if (measurement.frame.exposure_end > at_s(1.0)) measurement.servo.clear();
    observer.take(measurement);
    const bool is_known = measurement.frame.exposure_end <= at_s(1.5);
    EXPECT_EQ(observer.seen_with({.rest = true}).still_since.has_value(), is_known);
    EXPECT_FALSE(observer.seen_with({.rest = true}).is_told_to_move);
  }
}

TEST(WhatTheServoIsTold, BeginsAnewWhereStatesWereLostOrItsClockWentBack) {
  const auto state_at = [](double time_s, bool lost_before) {
    TimedServo state;
    state.stamp.time = at_s(time_s);
    state.lost_before = lost_before;
    return state;
  };
  ServoOrder order;
  order.add(std::vector{state_at(5.00, false), state_at(5.01, false)}, at_s(5.01));
  EXPECT_EQ(order.still_since(), at_s(5.00));
  order.add(std::vector{state_at(5.04, true)}, at_s(5.04));
  EXPECT_EQ(order.still_since(), at_s(5.04));
  order.add(std::vector{state_at(1.00, false)}, at_s(1.00));
  EXPECT_EQ(order.still_since(), at_s(1.00));
  order.add(std::vector{state_at(2.00, false)}, at_s(2.00));  // after a silence
  EXPECT_EQ(order.still_since(), at_s(2.00));
}

}  // namespace
}  // namespace thermorig::estimators
