// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <limits>

#include "thermorig/network/window_index.h"

namespace thermorig::network {
namespace {

Acquisition with_runs(std::vector<std::uint32_t> runs) {
  Acquisition acquisition;
  for (std::size_t frame = 0; frame < runs.size(); ++frame) {
    acquisition.label_dps.push_back(static_cast<float>(10 * frame));
    acquisition.gyro_dps.push_back(static_cast<float>(frame));
  }
  acquisition.run = std::move(runs);
  return acquisition;
}

std::vector<std::uint32_t> ends(const Acquisition& acquisition, int frames, int history = 0) {
  std::vector<std::uint32_t> last;
  for (const Window& window : find_windows({&acquisition, 1}, frames, history)) last.push_back(window.last);
  return last;
}

using Ends = std::vector<std::uint32_t>;

TEST(WindowRule, WantsConsecutiveFramesOfOneRun) {
  EXPECT_EQ(ends(with_runs({0, 1, 1, 1, 1, 0, 2, 2, 2}), 3), (Ends{3, 4, 8}));
}

TEST(WindowRule, StartsAnewWithEachRun) {
  EXPECT_EQ(ends(with_runs({1, 1, 2, 2, 2, 1, 1, 1}), 3), (Ends{4, 7}));
}

TEST(WindowRule, StartsAnewAfterAFrameThatIsNotValidThoughTheRunsNumberIsTheSame) {
  EXPECT_EQ(ends(with_runs({1, 1, 0, 1, 1, 1}), 3), (Ends{5}));
}

TEST(WindowRule, HistoryMakesWindowsOfAllLengthsEndAtTheSameFrames) {
  const Acquisition acquisition = with_runs({1, 1, 1, 1, 1, 1, 1, 0, 2, 2, 2});
  for (int frames = 2; frames <= 6; ++frames) EXPECT_EQ(ends(acquisition, frames, 6), (Ends{5, 6}));
}

TEST(WindowRule, HistoryBelowTheWindowsLengthChangesNothing) {
  EXPECT_EQ(ends(with_runs({1, 1, 1, 1}), 3, 2), (Ends{2, 3}));
}

TEST(WindowRule, CountsNoFurtherThanItNeeds) {
  WindowRule rule(3);
  for (int frame = 0; frame < 1000; ++frame) EXPECT_EQ(rule.push(7), frame >= 2);
}

TEST(FindWindows, NeverMixesAcquisitions) {
  const std::vector<Acquisition> two{with_runs({1, 1}), with_runs({1, 1, 1})};
  EXPECT_EQ(find_windows(two, 2), (std::vector<Window>{{0, 1}, {1, 1}, {1, 2}}));
}

TEST(FindWindows, FindsNoneInNothing) {
  EXPECT_TRUE(find_windows({}, 3).empty());
  EXPECT_TRUE(ends(with_runs({}), 3).empty());
  EXPECT_TRUE(ends(with_runs({0, 0, 0, 0}), 3).empty());
}

TEST(RatesOf, AreTheMeansOfTheWindowsFrames) {
  const Acquisition acquisition = with_runs({1, 1, 1, 1});
  const WindowRates rates = rates_of(acquisition, {0, 3}, 3);
  EXPECT_FLOAT_EQ(rates.label_dps, 20.0F);
  EXPECT_FLOAT_EQ(rates.gyro_dps, 2.0F);
}

TEST(RatesOf, LookAtNoFrameOutsideTheWindow) {
  Acquisition acquisition = with_runs({1, 1, 1, 1});
  acquisition.label_dps[0] = acquisition.gyro_dps[0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FLOAT_EQ(rates_of(acquisition, {0, 3}, 3).label_dps, 20.0F);
}

}  // namespace
}  // namespace thermorig::network
