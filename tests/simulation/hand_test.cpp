// SPDX-License-Identifier: MIT
#include "simulation/hand.h"

#include <gtest/gtest.h>

namespace thermorig::simulation {
namespace {

constexpr std::int64_t second_ns = 1'000'000'000;

Hand one_turn() {
  return Hand({{.begin = host_time_ns(12 * second_ns), .duration_s = 8.0, .angle_deg = 360.0}},
              host_time_ns(10 * second_ns));
}

TEST(Hand, TurnsTheWholeAngleFromRestToRest) {
  const Hand hand = one_turn();
  EXPECT_EQ(hand.angle_deg(0), 0.0);
  EXPECT_EQ(hand.angle_deg(2 * second_ns), 0.0);
  EXPECT_NEAR(hand.angle_deg(6 * second_ns), 180.0, 1e-9);
  EXPECT_NEAR(hand.angle_deg(10 * second_ns), 360.0, 1e-9);
  EXPECT_NEAR(hand.angle_deg(100 * second_ns), 360.0, 1e-9);
  for (const std::int64_t at_s : {0, 2, 10, 100}) EXPECT_NEAR(hand.rate_dps(at_s * second_ns), 0.0, 1e-9);
}

TEST(Hand, HasTheRateByWhichItsAngleGrows) {
  const Hand hand = one_turn();
  double fastest_dps = 0.0;
  for (std::int64_t ns = 0; ns < 12 * second_ns; ns += second_ns / 100) {
    const double grown_dps = (hand.angle_deg(ns + 1000) - hand.angle_deg(ns - 1000)) / 2e-6;
    EXPECT_NEAR(hand.rate_dps(ns), grown_dps, 1e-3);
    fastest_dps = std::max(fastest_dps, hand.rate_dps(ns));
  }
  EXPECT_NEAR(fastest_dps, 90.0, 1e-6);  // twice the mean
}

TEST(Hand, AddsTurnsUp) {
  const Hand hand({{.begin = host_time_ns(0), .duration_s = 1.0, .angle_deg = 90.0},
                   {.begin = host_time_ns(2 * second_ns), .duration_s = 1.0, .angle_deg = -30.0}},
                  host_time_ns(0));
  EXPECT_NEAR(hand.angle_deg(5 * second_ns), 60.0, 1e-9);
}

}  // namespace
}  // namespace thermorig::simulation
