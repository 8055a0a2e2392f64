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
  const EpochPlan first = epoch_plan(1000, 5, 1, 1), second = epoch_plan(1000, 5, 2, 1);
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
  EXPECT_EQ(epoch_plan(100, 5, 3, 2).order, epoch_plan(100, 5, 3, 2).order);
  EXPECT_EQ(epoch_plan(100, 5, 3, 2).turns, epoch_plan(100, 5, 3, 2).turns);
  EXPECT_EQ(epoch_plan(100, 5, 3, 2).order, epoch_plan(100, 5, 3, 1).order);
  EXPECT_NE(epoch_plan(100, 5, 3, 2).order, epoch_plan(100, 6, 3, 2).order);
}

TEST(EpochPlan, MirrorsHalfOfTheWindowsDrawnAnewEachEpoch) {
  const EpochPlan first = epoch_plan(10000, 5, 1, 2), second = epoch_plan(10000, 5, 2, 2);
  EXPECT_NEAR(static_cast<double>(std::count(first.turns.begin(), first.turns.end(), 1)), 5000.0, 250);
  EXPECT_NE(first.turns, second.turns);
  const EpochPlan without = epoch_plan(10000, 5, 1, 1);
  EXPECT_EQ(std::count(without.turns.begin(), without.turns.end(), 0), 10000);
}

TEST(EpochPlan, ShowsEachOfEightSymmetriesAsOften) {
  const EpochPlan plan = epoch_plan(80'000, 5, 1, 8);
  for (std::uint8_t turn = 0; turn < 8; ++turn)
    EXPECT_NEAR(static_cast<double>(std::count(plan.turns.begin(), plan.turns.end(), turn)), 10'000.0, 400);
}

TEST(EpochPlan, OfFewWindowsIsWhole) {
  EXPECT_TRUE(epoch_plan(0, 1, 1, 2).order.empty());
  EXPECT_EQ(epoch_plan(1, 1, 1, 2).order, std::vector<std::uint32_t>{0});
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
