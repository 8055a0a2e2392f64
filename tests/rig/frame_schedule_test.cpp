// SPDX-License-Identifier: MIT
#include "thermorig/rig/sweep/frame_schedule.h"

#include <gtest/gtest.h>

#include <cmath>

namespace thermorig::rig {
namespace {

TimedFrame frame_at(double middle_s, std::uint16_t missing_before = 0) {
  TimedFrame frame;
  frame.exposure_begin = HostTime{} + from_s(middle_s - 0.1875);
  frame.exposure_end = HostTime{} + from_s(middle_s + 0.0625);
  frame.missing_before = missing_before;
  return frame;
}

double next_s(const FrameSchedule& schedule) {
  return to_s(schedule.next_middle() - HostTime{});
}

TEST(FrameSchedule, MeasuresTheRateOnceEnoughFramesHaveCome) {
  FrameSchedule schedule(8.0);
  schedule.frame(frame_at(0.0));
  EXPECT_DOUBLE_EQ(schedule.rate_hz(), 8.0);
  for (int i = 1; i < 10; ++i) schedule.frame(frame_at(0.1 * i));
  EXPECT_NEAR(schedule.rate_hz(), 10.0, 1e-6);
}

TEST(FrameSchedule, MeasuresThroughTheStepsOfALatencyTimer) {
  FrameSchedule schedule(8.0);
  for (int i = 0; i < 40; ++i) schedule.frame(frame_at(0.016 * std::ceil(0.120 * i / 0.016)));
  EXPECT_NEAR(1.0 / schedule.rate_hz(), 0.120, 0.002);
}

TEST(FrameSchedule, ALateReadDoesNotMoveTheNextFrame) {
  FrameSchedule schedule(8.0);
  for (int i = 0; i < 20; ++i) schedule.frame(frame_at(0.1 * i));
  schedule.frame(frame_at(2.0 + 0.08));
  EXPECT_NEAR(next_s(schedule), 2.1, 1e-3);
}

TEST(FrameSchedule, CountsFramesThatNeverCame) {
  FrameSchedule schedule(8.0);
  for (int i = 0; i < 20; ++i) schedule.frame(frame_at(0.1 * i));
  schedule.frame(frame_at(2.2, 2));
  EXPECT_NEAR(next_s(schedule), 2.3, 1e-3);
  EXPECT_NEAR(schedule.rate_hz(), 10.0, 1e-3);
}

TEST(FrameSchedule, TellsHowManyFramesComeOfACameraThatLosesSome) {
  FrameSchedule schedule(8.0);
  for (int i = 0; i < 300; ++i)
    if (i % 3 != 0) schedule.frame(frame_at(0.1 * i, i % 3 == 1 ? 1 : 0));
  EXPECT_NEAR(schedule.rate_hz(), 10.0, 1e-3);
  EXPECT_NEAR(schedule.arrival_rate_hz(), 20.0 / 3.0, 0.2);
}

TEST(FrameSchedule, CountsNoFramesOfACameraThatWasAway) {
  FrameSchedule schedule(8.0);
  for (int i = 0; i < 40; ++i) schedule.frame(frame_at(0.1 * i));
  schedule.frame(frame_at(9.0, 50));
  EXPECT_DOUBLE_EQ(schedule.arrival_rate_hz(), schedule.rate_hz());
}

}  // namespace
}  // namespace thermorig::rig
