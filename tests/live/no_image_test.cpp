// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "thermorig/live/live_estimator.h"

namespace thermorig::live {
namespace {

TEST(LiveEstimator, ComparesGyroAndServoWhereThereIsNoImage) {
  LiveEstimator estimator{std::nullopt};
  TimedFrame frame;
  frame.frame.temp_c.fill(std::numeric_limits<float>::quiet_NaN());
  LabelledSample sample;
  sample.rate_commanded_dps = 40.0F;
  sample.rate_gyro_dps = 42.0F;
  sample.valid = true;
  sample.run = 1;
  EXPECT_TRUE(estimator.add(frame, sample, HostTime{}).counted);
  sample.run = 0;
  EXPECT_FALSE(estimator.add(frame, sample, HostTime{}).counted);
  sample.run = 2;
  frame.frame.temp_c[0] = 20.0F;  // an image, and a damaged one
  EXPECT_FALSE(estimator.add(frame, sample, HostTime{}).counted);
}

}  // namespace
}  // namespace thermorig::live
