// SPDX-License-Identifier: MIT
#include "thermorig/rig/sweep/driven_leg.h"

#include <gtest/gtest.h>

#include "support/at_s.h"

namespace thermorig::rig::test {
namespace {

/// Frames at 1, 2, 3, 4 s; telemetry until `heard_s`.
DrivenLeg driven(double heard_s) {
  DrivenLeg leg(LegRecord{.leg = 1}, 4, false);
  leg.acknowledge(at_s(0.0));
  leg.seen(at_s(0.1));
  for (int i = 1; i <= 4; ++i) leg.frame(at_s(i), at_s(i + 0.1), from_s(0.0));
  leg.seen(at_s(heard_s));
  return leg;
}

TEST(DrivenLeg, IsWholeWithTheFramesThatWerePlanned) {
  const DrivenLeg leg = driven(4.5);
  EXPECT_TRUE(leg.is_whole());
  EXPECT_EQ(leg.closed(at_s(5.0)).end, at_s(4.1));
}

TEST(DrivenLeg, ThatBrokeOffHasNoFramesBehindItsLastTelemetry) {
  DrivenLeg leg = driven(2.5);
  leg.broke_off();
  EXPECT_FALSE(leg.is_whole());
  EXPECT_EQ(leg.record().frames, 2U);
  EXPECT_EQ(leg.closed(at_s(5.0)).end, at_s(2.1));
}

TEST(DrivenLeg, ThatBrokeOffBehindItsLastFrameStaysWhole) {
  DrivenLeg leg = driven(4.5);
  leg.broke_off();
  EXPECT_TRUE(leg.is_whole());
}

TEST(DrivenLeg, GivesBackAFrameOfTheLegAfterIt) {
  DrivenLeg leg = driven(4.5);
  leg.take_back();
  EXPECT_EQ(leg.record().frames, 3U);
  EXPECT_EQ(leg.closed(at_s(5.0)).end, at_s(3.1));
}

/// Three of four frames have come when it is left, halfway to the fourth.
LeftLeg left_before_its_last() {
  DrivenLeg leg(LegRecord{.leg = 1}, 4, false);
  leg.seen(at_s(0.1));
  for (int i = 1; i <= 3; ++i) leg.frame(at_s(i), at_s(i + 0.1), from_s(0.0));
  return {leg, at_s(4.5)};
}
constexpr HostDuration frame_delay = std::chrono::milliseconds(100);

TEST(LeftLeg, IsSettledWithItsLastFrame) {
  LeftLeg leg = left_before_its_last();
  EXPECT_FALSE(leg.is_settled());
  leg.frame(at_s(4.0), at_s(4.1), from_s(0.0), frame_delay);
  EXPECT_TRUE(leg.is_settled());
  EXPECT_TRUE(leg.settled().is_whole());
}

TEST(LeftLeg, LacksAFrameThatTheOneAfterWasTakenFor) {
  LeftLeg leg = left_before_its_last();
  leg.frame(at_s(4.4), at_s(4.7), from_s(0.0), frame_delay);
  EXPECT_FALSE(leg.is_settled());
  EXPECT_EQ(leg.settled().record().frames, 3);
}

TEST(LeftLeg, BelievesALateLastFrameIfOneMoreComes) {
  LeftLeg leg = left_before_its_last();
  leg.frame(at_s(4.4), at_s(4.7), from_s(0.0), frame_delay);
  leg.frame(at_s(5.0), at_s(5.1), from_s(0.0), frame_delay);
  EXPECT_TRUE(leg.is_settled());
  EXPECT_TRUE(leg.settled().is_whole());
}

}  // namespace
}  // namespace thermorig::rig::test
