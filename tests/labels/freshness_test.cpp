// SPDX-License-Identifier: MIT
#include "thermorig/labels/freshness.h"

#include <gtest/gtest.h>

#include <limits>

namespace thermorig::labels {
namespace {

ThermalFrame flat(float temp_c) {
  ThermalFrame frame;
  frame.temp_c.fill(temp_c);
  return frame;
}

/// Changes the first `count` pixels of one chess half.
ThermalFrame changed(ThermalFrame frame, unsigned half, int count) {
  for (std::size_t i = 0; i < frame_pixels && count > 0; ++i)
    if (subpage_of(i / frame_columns, i % frame_columns) == half) {
      frame.temp_c[i] += 0.01F;
      --count;
    }
  return frame;
}

TEST(FreshnessDetector, TakesTheFirstFrameAsWhollyFresh) {
  FreshnessDetector detector;
  const Freshness fresh = detector.push(flat(20));
  EXPECT_EQ(fresh.even, 384);
  EXPECT_EQ(fresh.odd, 384);
}

TEST(FreshnessDetector, CountsEachHalfApart) {
  FreshnessDetector detector;
  ThermalFrame frame = flat(20);
  detector.push(frame);
  frame = changed(changed(frame, 0, 200), 1, 31);
  const Freshness fresh = detector.push(frame);
  EXPECT_EQ(fresh.even, 200);
  EXPECT_EQ(fresh.odd, 31);
}

TEST(FreshnessDetector, ComparesWithTheFrameJustBefore) {
  FreshnessDetector detector;
  const ThermalFrame first = flat(20);
  const ThermalFrame second = changed(first, 1, 384);
  detector.push(first);
  detector.push(second);
  const Freshness repeated = detector.push(second);
  EXPECT_TRUE(repeated.none_fresh());
  EXPECT_EQ(detector.push(first).odd, 384);
}

TEST(FreshnessDetector, AHalfIsFreshAboveTwoPercentOfItsPixels) {
  FreshnessDetector detector;
  ThermalFrame frame = flat(20);
  detector.push(frame);
  EXPECT_FALSE(detector.push(frame = changed(frame, 0, 7)).even_fresh());
  EXPECT_TRUE(detector.push(changed(frame, 0, 8)).even_fresh());
}

TEST(FreshnessDetector, NotANumberDiffersFromItself) {
  FreshnessDetector detector;
  const ThermalFrame frame = flat(std::numeric_limits<float>::quiet_NaN());
  detector.push(frame);
  EXPECT_TRUE(detector.push(frame).both_fresh());
}

TEST(ModeVote, GoesByTheMajority) {
  const Freshness even{.even = 384, .odd = 0}, odd{.even = 0, .odd = 384}, both{.even = 384, .odd = 384},
      none{.even = 0, .odd = 0};
  ModeVote vote;
  EXPECT_TRUE(vote.empty());
  EXPECT_EQ(vote.mode(), CameraMode::half_fresh);
  vote.push(none);
  EXPECT_TRUE(vote.empty());
  vote.push(both);
  EXPECT_EQ(vote.mode(), CameraMode::full_fresh);
  vote.push(even);
  EXPECT_EQ(vote.mode(), CameraMode::half_fresh);
  vote.push(both);
  EXPECT_EQ(vote.mode(), CameraMode::full_fresh);
  vote.push(odd);
  vote.push(even);
  EXPECT_EQ(vote.mode(), CameraMode::half_fresh);
}

}  // namespace
}  // namespace thermorig::labels
