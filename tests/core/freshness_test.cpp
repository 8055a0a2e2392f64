// SPDX-License-Identifier: MIT
#include "thermorig/core/freshness.h"

#include <gtest/gtest.h>

#include <limits>

namespace thermorig {
namespace {

using Frame = std::array<std::int16_t, frame_pixels>;

Frame flat(std::int16_t word) {
  Frame frame{};
  frame.fill(word);
  return frame;
}

/// Changes the first `count` pixels of one chess half.
Frame changed(Frame frame, unsigned half, int count) {
  for (std::size_t i = 0; i < frame_pixels && count > 0; ++i)
    if (subpage_of(i / frame_columns, i % frame_columns) == half) {
      ++frame[i];
      --count;
    }
  return frame;
}

TEST(FreshnessDetector, TakesTheFirstFrameAsWhollyFresh) {
  FreshnessDetector<std::int16_t> detector;
  const Freshness fresh = detector.push(flat(20));
  EXPECT_EQ(fresh.even, 384);
  EXPECT_EQ(fresh.odd, 384);
}

TEST(FreshnessDetector, CountsEachHalfApart) {
  FreshnessDetector<std::int16_t> detector;
  Frame frame = flat(20);
  detector.push(frame);
  frame = changed(changed(frame, 0, 200), 1, 31);
  const Freshness fresh = detector.push(frame);
  EXPECT_EQ(fresh.even, 200);
  EXPECT_EQ(fresh.odd, 31);
}

TEST(FreshnessDetector, ComparesWithTheFrameJustBefore) {
  FreshnessDetector<std::int16_t> detector;
  const Frame first = flat(20);
  const Frame second = changed(first, 1, 384);
  detector.push(first);
  detector.push(second);
  const Freshness repeated = detector.push(second);
  EXPECT_TRUE(repeated.none_fresh());
  EXPECT_EQ(detector.push(first).odd, 384);
}

TEST(FreshnessDetector, AHalfIsFreshAboveTwoPercentOfItsPixels) {
  FreshnessDetector<std::int16_t> detector;
  Frame frame = flat(20);
  detector.push(frame);
  EXPECT_FALSE(detector.push(frame = changed(frame, 0, 7)).even_fresh());
  EXPECT_TRUE(detector.push(changed(frame, 0, 8)).even_fresh());
}

TEST(FreshnessDetector, NotANumberDiffersFromItself) {
  FreshnessDetector<float> detector;
  std::array<float, frame_pixels> frame{};
  frame.fill(std::numeric_limits<float>::quiet_NaN());
  detector.push(frame);
  EXPECT_TRUE(detector.push(frame).both_fresh());
}

TEST(FreshnessDetector, AfterARestartTheNextFrameIsAFirstOne) {
  FreshnessDetector<std::int16_t> detector;
  detector.push(flat(20));
  detector.restart();
  EXPECT_EQ(detector.push(flat(20)).even, 384);
  EXPECT_EQ(detector.push(flat(20)).even, 0);
}

}  // namespace
}  // namespace thermorig
