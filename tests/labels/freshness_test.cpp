// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/labels/exposure.h"

#include <gtest/gtest.h>

namespace thermorig::labels {
namespace {

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
