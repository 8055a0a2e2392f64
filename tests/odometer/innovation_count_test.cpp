// SPDX-License-Identifier: MIT
#include "estimators/odometer/innovations.h"

#include <gtest/gtest.h>

#include <functional>

namespace thermorig::odometer {
namespace {

/// Halves against a map that is right, of a rig that turns to and fro. Each tenth does not fit at all: by
/// what `off_deg` says of its number and rate.
InnovationCount count_of(const std::function<double(int, double)>& off_deg) {
  InnovationCount count;
  for (int i = 0; i < 200; ++i) {
    const double rate_dps = i / 20 % 2 == 0 ? 80.0 : -80.0;
    const bool is_far_off = i % 10 == 0;
    count.add({.is_judged = true,
               .nis = is_far_off ? 25.0 : 0.7,
               .innovation_deg = is_far_off ? off_deg(i / 10, rate_dps) : 0.1,
               .rate_dps = rate_dps});
  }
  return count;
}

TEST(InnovationCount, TakesWhatLiesFarOffToBothSidesForTraffic) {
  EXPECT_TRUE(
      count_of([](int number, double) { return number % 2 == 0 ? 6.0 : -6.0; }).shows_traffic_after_start());
}

TEST(InnovationCount, DoesNotTakeAWrongBiasForTraffic) {
  EXPECT_FALSE(count_of([](int, double) { return 6.0; }).shows_traffic_after_start());
}

TEST(InnovationCount, DoesNotTakeWrongTimesForTraffic) {
  EXPECT_FALSE(count_of([](int, double rate_dps) { return 0.1 * rate_dps; }).shows_traffic_after_start());
}

TEST(InnovationCount, DoesNotTakeALensThatIsALittleOffForTraffic) {
  EXPECT_FALSE(
      count_of([](int number, double) { return number % 2 == 0 ? 1.0 : -1.0; }).shows_traffic_after_start());
}

TEST(InnovationCount, DoesNotTakeAKnockForTraffic) {
  InnovationCount count;
  for (int i = 0; i < 100; ++i) count.add({.is_judged = true, .nis = 0.7, .innovation_deg = 0.1});
  for (const double off_deg : {6.0, -6.0})
    count.add({.is_judged = true, .nis = 100.0, .innovation_deg = off_deg, .rate_dps = 50.0});
  EXPECT_FALSE(count.shows_traffic_after_start());
}

/// There a heading may be degrees off, and that is expected.
TEST(InnovationCount, DoesNotTakeABareWallForTraffic) {
  InnovationCount count = count_of([](int number, double) { return number % 2 == 0 ? 1.0 : -1.0; });
  for (int i = 0; i < 40; ++i)
    count.add({.is_judged = true, .nis = 1.0, .innovation_deg = i % 2 == 0 ? 5.0 : -5.0});
  EXPECT_FALSE(count.shows_traffic_after_start());
}

TEST(InnovationCount, ForgetsWhatCameLongAgo) {
  InnovationCount count = count_of([](int number, double) { return number % 2 == 0 ? 6.0 : -6.0; });
  ASSERT_TRUE(count.shows_traffic_after_start());
  for (int i = 0; i < 3; ++i) count.forget_half();
  EXPECT_EQ(count.judged(), 25);
  for (int i = 0; i < 200; ++i) count.add({.is_judged = true, .nis = 0.7, .innovation_deg = 0.1});
  EXPECT_FALSE(count.shows_traffic_after_start());
}

}  // namespace
}  // namespace thermorig::odometer
