// SPDX-License-Identifier: MIT
#include "thermorig/core/surroundings/turn_path.h"

#include <gtest/gtest.h>

#include <array>

namespace thermorig {
namespace {

/// A second at 200 samples, that begins at rest and speeds up by 100 deg/s^2.
TurnPath speeding_up(std::size_t kept = 201) {
  TurnPath path(kept);
  for (int i = 0; i <= 200; ++i) path.add(0.005 * i, 100.0 * 0.005 * i);
  return path;
}

TEST(TurnPath, KnowsWhatWasTurnedAtAnyTime) {
  const TurnPath path = speeding_up();
  EXPECT_NEAR(path.until(0.5).turned_deg, 12.5, 1e-9);
  EXPECT_NEAR(path.until(0.5025).turned_deg, 50.0 * 0.5025 * 0.5025, 1e-9);
  EXPECT_NEAR(path.until(1.1).turned_deg, 50.0 + 10.0, 1e-9);  // its rate goes on
  const ExposedTurn turn = path.over(0.4, 0.6);
  EXPECT_NEAR(turn.mean_deg, 50.0 * (0.25 + 0.04 / 12.0), 1e-3);
  EXPECT_NEAR(turn.end_deg - turn.begin_deg, 10.0, 1e-9);
}

TEST(TurnPath, KnowsTheSameAtManyTimesAtOnce) {
  const TurnPath path = speeding_up();
  std::array<double, 50> turned_deg;
  path.turned(-0.1, 0.0251, turned_deg);  // before its begin, and beyond its end
  for (std::size_t i = 0; i < turned_deg.size(); ++i)
    EXPECT_DOUBLE_EQ(turned_deg[i], path.until(-0.1 + 0.0251 * static_cast<double>(i)).turned_deg);
}

TEST(TurnPath, TellsMeansOverAnyInterval) {
  const TurnPath path = speeding_up();
  const TurnPath::Mean mean = path.mean_over(0.4, 0.6);
  EXPECT_NEAR(mean.turned_deg, 50.0 * (0.25 + 0.04 / 12.0), 1e-3);
  EXPECT_NEAR(mean.rate_dps, 50.0, 1e-9);
  EXPECT_NEAR(path.mean_over(2.0, 3.0).turned_deg, 50.0, 1e-9);  // beyond its end it stays
  EXPECT_NEAR(path.mean_over(-1.0, 0.0).rate_dps, 0.0, 1e-9);
}

TEST(TurnPath, FindsTimesAlsoWhereSamplesComeUnevenly) {
  TurnPath path(4000);
  for (int i = 0; i < 2000; ++i) path.add(0.001 * i, 10.0);
  for (int i = 0; i < 2000; ++i) path.add(2.0 + 0.1 * i, 10.0);
  for (const double time_s : {0.0004, 1.9995, 2.05, 150.03, 201.8})
    EXPECT_NEAR(path.until(time_s).turned_deg, 10.0 * time_s, 1e-6) << time_s;
}

TEST(TurnPath, ForgetsTheOldestSamplesAndNotWhatWasTurned) {
  const TurnPath path = speeding_up(50);
  EXPECT_NEAR(path.begin_s(), 0.755, 1e-12);
  EXPECT_NEAR(path.until(0.9).turned_deg, 50.0 * 0.81, 1e-9);
}

}  // namespace
}  // namespace thermorig
