// SPDX-License-Identifier: MIT
#include "estimators/odometer/heading_filter.h"

#include <gtest/gtest.h>

#include "thermorig/core/surroundings/turn_path.h"

namespace thermorig::odometer {
namespace {

using Shares = std::array<double, HeadingFilter::nodes>;

const HeadingFilter::Vector of_heading{1.0};  // of a still rig's exposure

/// An exposure that ends now, at a constant reading.
ExposedTurn turn_at(double read_dps) {
  TurnPath path;
  for (int i = 0; i <= 200; ++i) path.add(0.005 * i, read_dps, 0.0);
  return path.over(0.875, 1.0);
}

TEST(HeadingFilter, TurnsByTheReadingLessBiasAndScale) {
  HeadingFilter filter({.bias_dps = 2.0, .scale = 1.1});
  filter.predict(24.0, 1.0, 0.0);
  EXPECT_NEAR(filter.heading_deg(), 20.0, 1e-9);
}

TEST(HeadingFilter, LooksAtTheMiddleOfAnExposure) {
  const HeadingFilter filter({.bias_dps = 0.0});
  const ExposedTurn turn = turn_at(80.0);
  EXPECT_NEAR(filter.exposed_deg(turn, 1.0, 80.0), -5.0, 1e-6);  // half of 0.125 s ago
  EXPECT_NEAR(std::sqrt(3.0) * filter.spread_deg(turn), 5.0, 0.02);
  EXPECT_NEAR(filter.mean_rate_dps(turn), 80.0, 1e-6);
}

TEST(HeadingFilter, LearnsTheBiasFromAHeading) {
  HeadingFilter filter({.bias_sigma_dps = 10.0});
  filter.begin_nodes(-30.0, 30.0, of_heading);
  filter.predict(5.0, 1.0, 0.0);  // it stood still
  Shares ahead{};
  HeadingFilter::add_shares(0.0, 1.0, ahead);
  const auto row = filter.jacobian(turn_at(5.0), 1.0, 5.0, ahead);
  filter.update(row, -filter.exposed_deg(turn_at(5.0), 1.0, 5.0), 1e-6);
  EXPECT_NEAR(filter.bias_dps(), 5.0, 0.05);
  EXPECT_LT(filter.sigma(HeadingFilter::bias), 0.2);
}

TEST(HeadingFilter, BlamesTheMapWhereItWasMadeWithTheSameError) {
  HeadingFilter filter({.bias_sigma_dps = 1.0});
  filter.predict(0.0, 10.0, 0.0);  // 10 deg of error by now
  filter.begin_nodes(-30.0, 30.0, of_heading);
  Shares ahead{};
  HeadingFilter::add_shares(0.0, 1.0, ahead);
  auto row = filter.jacobian(turn_at(0.0), 1.0, 0.0, ahead);
  row[HeadingFilter::bias] = row[HeadingFilter::latency] = row[HeadingFilter::scale] = 0.0;
  EXPECT_LT(filter.variance(row), 1e-6);  // heading against that part of the map
  EXPECT_GT(filter.sigma(HeadingFilter::heading), 9.0);
}

TEST(HeadingFilter, TakesPartsOfTheMapForOffEachByItself) {
  HeadingFilter filter({.bias_sigma_dps = 0.0, .map_sigma_deg = 0.4});
  filter.begin_nodes(-30.0, 90.0, of_heading);
  const auto of = [&](double azimuth_deg) {
    Shares about{};
    HeadingFilter::add_shares(azimuth_deg, 1.0, about);
    auto row = filter.jacobian(turn_at(0.0), 1.0, 0.0, about);
    row[HeadingFilter::bias] = row[HeadingFilter::latency] = row[HeadingFilter::scale] = 0.0;
    return row;
  };
  EXPECT_NEAR(std::sqrt(filter.variance(of(60.0))), 0.4, 1e-3);
  filter.update(of(0.0), 0.2, 1e-6);
  EXPECT_NEAR(filter.map_offset_deg(0.0), -0.2, 1e-3);
  EXPECT_NEAR(filter.map_offset_deg(60.0), 0.0, 1e-3);
  EXPECT_NEAR(std::sqrt(filter.variance(of(60.0))), 0.4, 1e-3);
}

TEST(HeadingFilter, LearnsTheLatencyFromAnotherSpeedAlone) {
  HeadingFilter filter({.bias_sigma_dps = 0.0, .scale_sigma = 0.0, .latency_sigma_s = 0.01});
  const ExposedTurn turn = turn_at(60.0), back = turn_at(-60.0);
  filter.begin_nodes(-40.0, 30.0, filter.jacobian(turn, 1.0, 60.0));
  Shares ahead{};
  HeadingFilter::add_shares(filter.exposed_deg(turn, 1.0, 60.0), 1.0, ahead);
  // What the map shows at the speed at which it was made is off by as much.
  filter.update(filter.jacobian(turn, 1.0, 60.0, ahead), 0.3, 0.01);
  EXPECT_NEAR(filter.latency_s(), 0.0, 1e-6);
  EXPECT_NEAR(filter.sigma(HeadingFilter::latency), 0.01, 1e-4);
  filter.update(filter.jacobian(back, 1.0, -60.0, ahead), 0.6, 1e-6);
  EXPECT_NEAR(filter.latency_s(), 0.005, 1e-4);  // 120 deg/s apart
}

TEST(HeadingFilter, BlamesTheMapWhereItWasWrittenAgainWithTheErrorOfNow) {
  HeadingFilter filter({.bias_sigma_dps = 1.0});
  filter.begin_nodes(-30.0, 30.0, of_heading);
  filter.predict(0.0, 10.0, 0.0);  // 10 deg of error since
  Shares ahead{};
  HeadingFilter::add_shares(0.0, 1.0, ahead);
  auto row = filter.jacobian(turn_at(0.0), 1.0, 0.0, ahead);
  row[HeadingFilter::bias] = row[HeadingFilter::latency] = row[HeadingFilter::scale] = 0.0;
  EXPECT_GT(filter.variance(row), 80.0);
  filter.rewrite(Shares{0.5}, of_heading);  // the node ahead
  EXPECT_NEAR(std::sqrt(filter.variance(row)), 5.0, 0.1);
  filter.rewrite(Shares{1.0}, of_heading);
  EXPECT_LT(filter.variance(row), 1e-6);
  EXPECT_GT(filter.sigma(HeadingFilter::heading), 9.0);
}

TEST(HeadingFilter, KnowsThatTheMapHasAGapUntilAllOfItWasSeen) {
  HeadingFilter filter({});
  filter.begin_nodes(-30.0, 300.0, of_heading);
  EXPECT_TRUE(filter.has_gap());
  filter.begin_nodes(270.0, 360.0, of_heading);
  EXPECT_FALSE(filter.has_gap());
}

TEST(HeadingFilter, InterpolatesTheMapsOffsetAcrossTheOrigin) {
  Shares shares{};
  HeadingFilter::add_shares(-7.5, 1.0, shares);
  EXPECT_NEAR(shares[23], 0.5, 1e-12);
  EXPECT_NEAR(shares[0], 0.5, 1e-12);
}

TEST(HeadingFilter, AHeadingThatWasFoundIsNoSurerThanHowLateTheCameraIs) {
  Priors priors;
  priors.latency_sigma_s = 0.03;
  HeadingFilter filter(priors);
  const ExposedTurn turn = turn_at(100.0);
  const auto exposed = filter.jacobian(turn, 1.0, 100.0);
  filter.find_heading(exposed, 20.0, 0.5);
  EXPECT_NEAR(filter.heading_deg(), 20.0, 1e-9);
  EXPECT_NEAR(std::sqrt(filter.variance(exposed)), 0.5, 0.01) << "where it looked";
  EXPECT_NEAR(filter.sigma(HeadingFilter::heading), std::hypot(0.5, 100.0 * 0.03, 0.0625 * 20.0), 0.1);
}

}  // namespace
}  // namespace thermorig::odometer
