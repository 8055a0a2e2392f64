// SPDX-License-Identifier: MIT
#include "thermorig/core/gyro_blocks.h"

#include <gtest/gtest.h>

#include "support/at_s.h"

namespace thermorig::gyro_blocks_tests {
namespace {

using std::chrono::milliseconds;

/// 100 samples a second from `begin_s` to before `end_s`, which alternate about a mean.
void add_samples(std::vector<TimedGyro>& gyro, double begin_s, double end_s, float mean_dps) {
  const int count = static_cast<int>(std::lround(100.0 * (end_s - begin_s)));
  for (int i = 0; i < count; ++i) {
    TimedGyro sample;
    sample.stamp.time = at_s(begin_s + 0.01 * i);
    sample.rate_dps = mean_dps + (i % 2 == 0 ? 0.1F : -0.1F);
    sample.reading.rate_dps = {0.0F, 0.0F, 3.0F * sample.rate_dps};
    gyro.push_back(sample);
  }
}

TEST(GyroBlocks, HaveTheMeanAndTheNoiseOfTheirSamples) {
  std::vector<TimedGyro> gyro;
  add_samples(gyro, 0.0, 0.5, 2.0F);
  add_samples(gyro, 0.5, 1.0, -1.0F);
  const auto blocks = gyro_blocks(gyro, at_s(0.0), at_s(1.2), {milliseconds(500)});
  ASSERT_EQ(blocks.size(), 2U);
  EXPECT_EQ(blocks[1].begin, at_s(0.5));
  EXPECT_NEAR(blocks[0].mean_dps(), 2.0, 1e-6);
  EXPECT_NEAR(blocks[1].mean_dps(), -1.0, 1e-6);
  EXPECT_NEAR(blocks[1].deviation_dps(), 0.1, 1e-6);
  EXPECT_NEAR(blocks[1].largest_deviation_dps(), 0.3, 1e-6);
}

TEST(GyroBlocks, BeginAnewWithTheFirstSampleBehindAPause) {
  std::vector<TimedGyro> gyro;
  add_samples(gyro, 0.0, 0.5, 0.0F);
  add_samples(gyro, 100.3, 101.0, 0.0F);
  const auto blocks = gyro_blocks(gyro, at_s(0.0), at_s(101.0), {milliseconds(500), 20});
  ASSERT_EQ(blocks.size(), 2U);
  EXPECT_EQ(blocks[1].begin, at_s(100.3));
}

TEST(GyroBlocks, LeaveOutSamplesThatDoNotCountAndAreLeftOutWithFewOthers) {
  std::vector<TimedGyro> gyro;
  add_samples(gyro, 0.0, 1.0, 1.0F);
  for (std::size_t i = 50; i < 90; ++i) gyro[i].reading.saturated = true;
  const auto counts = [](const TimedGyro& sample) { return !sample.reading.saturated; };
  const auto blocks = gyro_blocks(gyro, at_s(0.0), at_s(1.0), {milliseconds(500), 20, counts});
  ASSERT_EQ(blocks.size(), 1U);
  EXPECT_EQ(blocks[0].shaft_dps.count(), 50U);
}

}  // namespace
}  // namespace thermorig::gyro_blocks_tests
