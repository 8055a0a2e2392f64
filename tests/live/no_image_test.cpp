// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "thermorig/estimators/live/live_estimates.h"

namespace thermorig::live {
namespace {

TEST(LiveEstimates, ComparesGyroAndServoWhereThereIsNoImage) {
  LiveEstimates estimator(estimators::Bank({}, std::nullopt, RigProfile()));
  Measurement measurement;
  TimedFrame& frame = measurement.frame;
  frame.stands_in = true;
  frame.frame.temp_c.fill(std::numeric_limits<float>::quiet_NaN());
  LabelledSample& sample = measurement.sample;
  sample.rate_commanded_dps = 40.0F;
  sample.rate_gyro_dps = 42.0F;
  sample.valid = true;
  sample.run = 1;
  EXPECT_TRUE(estimator.add(measurement, HostTime{}).counted);
  sample.run = 0;
  EXPECT_FALSE(estimator.add(measurement, HostTime{}).counted);
  sample.run = 2;
  frame.stands_in = false;  // an image, and a damaged one
  EXPECT_FALSE(estimator.add(measurement, HostTime{}).counted);
}

}  // namespace
}  // namespace thermorig::live
