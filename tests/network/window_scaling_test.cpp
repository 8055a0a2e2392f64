// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "random_windows.h"
#include "thermorig/network/scaling.h"
#include "thermorig/network/turn.h"

namespace thermorig::network {
namespace {

/// Rows of different temperatures, with noise of some 0.6 K.
std::vector<float> degrees(const Shape& shape, std::uint64_t seed = 1) {
  Draw draw(seed);
  std::vector<float> window(shape.inputs());
  for (std::size_t i = 0; i < window.size(); ++i) {
    const std::size_t row =
        i / static_cast<std::size_t>(shape.columns()) % static_cast<std::size_t>(shape.rows());
    window[i] = static_cast<float>(20.0 + 0.5 * static_cast<double>(row) + draw());
  }
  return window;
}

std::vector<float> scaled(std::vector<float> window, const Shape& shape) {
  scale_window(window, shape);
  return window;
}

void expect_near(const std::vector<float>& one, const std::vector<float>& other, float tolerance) {
  ASSERT_EQ(one.size(), other.size());
  for (std::size_t i = 0; i < one.size(); ++i) ASSERT_NEAR(one[i], other[i], tolerance) << i;
}

const std::vector<Shape> shapes{
    {.frames = 3, .reduction = 1}, {.frames = 6, .reduction = 2}, {.frames = 2, .reduction = 3}};

TEST(WindowScaling, LeavesEachRowWithoutAMeanAndTheWindowWithADeviationOfOne) {
  for (const Shape& shape : shapes) {
    const std::vector<float> window = scaled(degrees(shape), shape);
    double squares = 0.0;
    for (const float value : window) squares += static_cast<double>(value) * value;
    EXPECT_NEAR(squares / static_cast<double>(window.size()), 1.0, 0.02);
    double first_row = 0.0;
    for (int frame = 0; frame < shape.frames; ++frame)
      for (int x = 0; x < shape.columns(); ++x)
        first_row += window[static_cast<std::size_t>(frame) * shape.pixels() + static_cast<std::size_t>(x)];
    EXPECT_NEAR(first_row, 0.0, 0.01);
  }
}

TEST(WindowScaling, DoesNotSeeTheRoomsTemperatureNorItsContrast) {
  for (const Shape& shape : shapes) {
    const std::vector<float> window = degrees(shape);
    std::vector<float> other = window;
    for (std::size_t i = 0; i < other.size(); ++i) other[i] = 3.0F * window[i] - 40.0F;
    expect_near(scaled(other, shape), scaled(window, shape), 1e-3F);
  }
}

TEST(WindowScaling, IsNotMovedByADeadPixelWhichItClamps) {
  const Shape shape = shapes.front();
  std::vector<float> window = degrees(shape);
  const std::vector<float> before = scaled(window, shape);
  for (std::size_t frame = 0; frame < 3; ++frame) window[frame * shape.pixels() + 100] = 300.0F;
  const std::vector<float> after = scaled(window, shape);
  EXPECT_EQ(after[100], 4.0F);
  EXPECT_NEAR(after[101], before[101], 0.1F);  // of the same row
  EXPECT_NEAR(after[500], before[500], 0.01F);
}

TEST(WindowScaling, OfAWallThatShowsNothingIsZero) {
  const Shape shape = shapes.front();
  for (const float value : scaled(std::vector<float>(shape.inputs(), 21.5F), shape)) EXPECT_EQ(value, 0.0F);
}

TEST(Turn, IsDoneBeforeOrAfterTheScaling) {
  for (const Shape& shape : shapes)
    for (std::uint8_t bits = 0; bits < Turn::all; ++bits) {
      const std::vector<float> window = degrees(shape);
      std::vector<float> turned_first(window.size()), turned_last(window.size());
      turn_window(window, shape, Turn(bits), turned_first);
      turn_window(scaled(window, shape), shape, Turn(bits), turned_last);
      expect_near(scaled(turned_first, shape), turned_last, 1e-4F);
    }
}

TEST(Turn, NegatesTheSpeedWhereItIsMirroredOrBackwardsButNotBoth) {
  for (std::uint8_t bits = 0; bits < Turn::all; ++bits) {
    const Turn turn(bits);
    EXPECT_EQ(turn.sign(), turn.mirrored() == turn.backwards() ? 1.0F : -1.0F);
  }
  const Shape shape{.frames = 2, .reduction = 3};
  std::vector<float> window(shape.inputs()), turned(window.size());
  for (std::size_t i = 0; i < window.size(); ++i) window[i] = static_cast<float>(i);
  turn_window(window, shape, Turn(7), turned);  // all three: every pixel the other way round
  EXPECT_TRUE(std::equal(turned.rbegin(), turned.rend(), window.begin()));
}

TEST(TurnedOutputs, AreWeighedByTheirOddsAndHaveTheirTurnsSign) {
  TurnedOutputs sum;
  sum.add({.thermal = 0.5F, .gain = 0.5F}, Turn(0), true);
  sum.add({.thermal = -0.8F, .gain = 0.8F}, Turn(1), true);  // mirrored; odds of 4 against 1
  const Output mean = sum.mean(0.1F, true);
  EXPECT_NEAR(mean.thermal, (0.5F + 4.0F * 0.8F) / 5.0F, 1e-6F);
  EXPECT_NEAR(mean.gain, 0.75F, 1e-6F);  // odds of 1.5 sqrt(1 x 4)
  EXPECT_NEAR(mean.fusion, 0.75F * mean.thermal + 0.25F * 0.1F, 1e-6F);
}

TEST(TurnedOutputs, OfAThermalOnlyNetCountAlike) {
  TurnedOutputs sum;
  sum.add({.thermal = 0.4F}, Turn(2), false);
  sum.add({.thermal = -0.6F}, Turn(4), false);
  EXPECT_NEAR(sum.mean(0.9F, false).fusion, 0.5F, 1e-6F);
}

TEST(Scaling, OfSpeedsFollowsTheTimeBetweenFrames) {
  const Scaling scaling = scaling_by_window();
  EXPECT_EQ(scaling.speed_scale_dps(0.125), 200.0F);
  EXPECT_EQ(scaling.speed_scale_dps(0.25), 100.0F);
  EXPECT_EQ(Scaling{}.speed_scale_dps(0.25), 200.0F);  // scaled by a data set: deg/s, as ever
}

}  // namespace
}  // namespace thermorig::network
