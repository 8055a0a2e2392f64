// SPDX-License-Identifier: MIT
#include "learning/training/epoch_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "learning/training/draw.h"

namespace thermorig::training {
namespace {

TEST(EpochPlan, GoesThroughEveryWindowOnceInAnotherOrderEachEpoch) {
  const EpochPlan first = epoch_plan(1000, 5, 1, false), second = epoch_plan(1000, 5, 2, false);
  std::vector<std::uint32_t> all(1000);
  std::iota(all.begin(), all.end(), 0U);
  EXPECT_NE(first.order, second.order);
  for (EpochPlan plan : {first, second}) {
    EXPECT_NE(plan.order, all);
    std::sort(plan.order.begin(), plan.order.end());
    EXPECT_EQ(plan.order, all);
  }
}

TEST(EpochPlan, DependsOnSeedAndEpochAlone) {
  EXPECT_EQ(epoch_plan(100, 5, 3, true).order, epoch_plan(100, 5, 3, true).order);
  EXPECT_EQ(epoch_plan(100, 5, 3, true).mirrored, epoch_plan(100, 5, 3, true).mirrored);
  EXPECT_EQ(epoch_plan(100, 5, 3, true).order, epoch_plan(100, 5, 3, false).order);
  EXPECT_NE(epoch_plan(100, 5, 3, true).order, epoch_plan(100, 6, 3, true).order);
}

TEST(EpochPlan, MirrorsHalfOfTheWindowsDrawnAnewEachEpoch) {
  const EpochPlan first = epoch_plan(10000, 5, 1, true), second = epoch_plan(10000, 5, 2, true);
  EXPECT_NEAR(static_cast<double>(std::count(first.mirrored.begin(), first.mirrored.end(), true)), 5000.0,
              250);
  EXPECT_NE(first.mirrored, second.mirrored);
  const EpochPlan without = epoch_plan(10000, 5, 1, false);
  EXPECT_EQ(std::count(without.mirrored.begin(), without.mirrored.end(), true), 0);
}

TEST(EpochPlan, OfFewWindowsIsWhole) {
  EXPECT_TRUE(epoch_plan(0, 1, 1, true).order.empty());
  EXPECT_EQ(epoch_plan(1, 1, 1, true).order, std::vector<std::uint32_t>{0});
}

TEST(Draw, IsEvenlySpread) {
  Draw draw(3, "test");
  std::array<int, 7> drawn{};
  for (int i = 0; i < 70'000; ++i) ++drawn.at(draw.below(7));
  for (const int count : drawn) EXPECT_NEAR(count, 10'000, 400);
}

TEST(Draw, HasASequenceOfItsOwnForEachPurposeAndEpoch) {
  const std::uint64_t first = Draw(3, "order", 1).bits();
  EXPECT_EQ(first, Draw(3, "order", 1).bits());
  EXPECT_NE(first, Draw(3, "order", 2).bits());
  EXPECT_NE(first, Draw(3, "mirror", 1).bits());
  EXPECT_NE(first, Draw(4, "order", 1).bits());
}

}  // namespace
}  // namespace thermorig::training
