// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>

#include "../odometer/room.h"
#include "hand_made.h"

namespace thermorig::estimators {
namespace {

std::vector<Measurement> turning(double rate_dps, double contrast_k) {
  odometer::Room room;
  room.duration_s = 8.0;
  room.angle_deg = [rate_dps](double time_s) { return rate_dps * time_s; };
  room.contrast_k = contrast_k;
  std::vector<Measurement> measurements;
  for (const odometer::Seen& seen : seen_in(room)) measurements.push_back({.frame = seen.frame});
  return measurements;
}

std::vector<RateEstimate> told_of(const std::vector<Measurement>& measurements, int frames) {
  Bank bank(std::vector<std::string>{"thermal-likelihood"}, std::nullopt, {}, {}, frames);
  return estimates_of(bank, measurements);
}

TEST(ThermalLikelihood, TellsTheRateOfAWindowByTheImagesAlone) {
  for (const int frames : {1, 2, 3, 6}) {
    const auto estimates = told_of(turning(-60.0, 0.8), frames);
    const RateEstimate& last = estimates.back();
    EXPECT_EQ(last.state, EstimateState::good) << frames;
    EXPECT_NEAR(last.rate_dps, -60.0F, 4.0F * last.rate_sigma_dps) << frames;
    EXPECT_EQ(estimates[static_cast<std::size_t>(frames) - 1].state, EstimateState::absent);
    EXPECT_EQ(estimates.front().reason, EstimateReason::window_incomplete);
    EXPECT_NEAR(last.values[0], 0.5F, 0.1F);  // noise of a reading
    EXPECT_NEAR(last.values[1], 1.0F, 0.3F);
  }
}

TEST(ThermalLikelihood, IntegratesItsRatesAndKnowsTheAngleTheWorseTheLongerThatTakes) {
  const auto estimates = told_of(turning(60.0, 0.8), 3);
  const RateEstimate &middle = estimates[30], &last = estimates.back();
  const double turned_deg = 60.0 * 0.125 * static_cast<double>(estimates.size() - 31);
  EXPECT_NEAR(last.angle_deg - middle.angle_deg, turned_deg, 3.0 * double{last.angle_sigma_deg});
  EXPECT_GT(last.angle_sigma_deg, middle.angle_sigma_deg);
}

TEST(ThermalLikelihood, OfAWallSaysThatThereIsNothingToSee) {
  int nothing = 0;
  const auto estimates = told_of(turning(60.0, 0.0), 3);
  for (const RateEstimate& one : estimates)
    if (one.state == EstimateState::not_trusted) {
      EXPECT_EQ(one.reason, EstimateReason::nothing_to_see);
      EXPECT_GE(one.rate_sigma_dps, 20.0F);
      ++nothing;
    }
  EXPECT_GT(nothing, 40);
}

TEST(ThermalLikelihood, WithoutImagesSaysSoAndItsAngleIsLost) {
  auto measurements = turning(60.0, 0.8);
  for (std::size_t i = 20; i < 40; ++i) measurements[i].frame.stands_in = true;
  const auto estimates = told_of(measurements, 3);
  EXPECT_EQ(estimates[30].state, EstimateState::absent);
  EXPECT_EQ(estimates[30].reason, EstimateReason::no_image);
  EXPECT_GT(estimates[40].angle_sigma_deg, estimates[19].angle_sigma_deg + 200.0F);
}

}  // namespace
}  // namespace thermorig::estimators
