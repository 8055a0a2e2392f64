// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <utility>

#include "thermorig/fit/fit.h"

namespace thermorig::fit {

using namespace pipeline;

namespace {

TimedFrame frame_at(double t, std::uint16_t even, std::uint16_t odd) {
  TimedFrame frame;
  frame.stamp.time = HostTime(from_s(t));
  frame.fresh_even = even;
  frame.fresh_odd = odd;
  return frame;
}

/// Half-fresh frames every `period_s`, their times seen in steps of `tick_s`, some of them damaged on the
/// way.
Streams half_fresh(int frames, double period_s, double tick_s, unsigned lost_percent) {
  std::mt19937 random(5);
  Streams streams;
  bool lost = false;
  for (int i = 0; i < frames; ++i) {
    const bool lost_before = std::exchange(lost, random() % 100 < lost_percent);
    if (lost) continue;
    const double t = std::ceil(period_s * i / tick_s) * tick_s;
    streams.frames.push_back(
        frame_at(t, i % 2 == 0 || lost_before ? 380 : 0, i % 2 != 0 || lost_before ? 380 : 0));
    streams.frames.back().resync_before = lost_before;
  }
  return streams;
}

TEST(Fit, FindsThePeriodBetweenTheTicksOfALatencyTimer) {
  const Fits fits = fit_recording({}, half_fresh(500, 0.12755, 0.016, 0));
  ASSERT_TRUE(fits.frame_period_s);
  EXPECT_NEAR(*fits.frame_period_s, 0.12755, 0.0001);
}

TEST(Fit, DoesNotCountIntervalsWithLostFrames) {
  const Fits fits = fit_recording({}, half_fresh(500, 0.12755, 0.001, 10));
  ASSERT_TRUE(fits.frame_period_s);
  EXPECT_NEAR(*fits.frame_period_s, 0.12755, 0.0001);
}

TEST(Fit, IsNotMovedByReadsThatComeLate) {
  std::mt19937 random(3);
  Streams streams = half_fresh(200, 0.12755, 0.001, 0);
  for (TimedFrame& frame : streams.frames)
    if (random() % 100 < 30) frame.stamp.time += from_s(0.001 * static_cast<double>(random() % 180));
  EXPECT_NEAR(*fit_recording({}, streams).frame_period_s, 0.12755, 0.0003);
}

TEST(Fit, IsNotMovedByAPauseOfTheCamera) {
  Streams streams = half_fresh(200, 0.12755, 0.001, 0);
  for (std::size_t i = 100; i < 200; ++i) streams.frames[i].stamp.time += from_s(10.0);
  EXPECT_NEAR(*fit_recording({}, streams).frame_period_s, 0.12755, 0.0005);
}

TEST(Fit, TakesAStalledHostForNoLoss) {
  Streams streams = half_fresh(90, 0.12755, 0.001, 0);
  for (TimedFrame& frame : streams.frames) {
    const double t = to_s(frame.stamp.time.time_since_epoch());
    for (const double stall : {3.0, 8.0})
      if (t > stall && t < stall + 0.6) frame.stamp.time = HostTime(from_s(stall + 0.6));
  }
  const Fits fits = fit_recording({}, streams);
  EXPECT_NEAR(*fits.frame_period_s, 0.12755, 0.00025);
  unsigned missing = 0, late = 0;
  for (const labels::FrameGap& gap : fits.gaps) {
    missing += gap.missing;
    late += gap.late ? 1 : 0;
  }
  EXPECT_EQ(missing, 0U);
  EXPECT_NEAR(late, 8, 2);
}

TEST(Fit, TakesTheModeOfTheMajorityAfterTheFirstFrame) {
  Streams streams;
  streams.frames = {frame_at(0.0, 384, 384), frame_at(0.1, 380, 0)};
  EXPECT_EQ(fit_recording({}, streams).camera_mode, labels::CameraMode::half_fresh);
  streams.frames = {frame_at(0.0, 384, 0), frame_at(0.1, 380, 380), frame_at(0.2, 380, 380),
                    frame_at(0.3, 0, 380)};
  EXPECT_EQ(fit_recording({}, streams).camera_mode, labels::CameraMode::full_fresh);
}

TEST(Fit, SaysNothingOfWhatItHasNotSeen) {
  EXPECT_FALSE(fit_recording({}, {}).camera_mode);
  EXPECT_FALSE(fit_recording({}, {}).frame_period_s);
  Streams one;
  one.frames = {frame_at(0.0, 384, 384)};
  EXPECT_FALSE(fit_recording({}, one).camera_mode);
  EXPECT_FALSE(fit_recording({}, one).frame_period_s);
  one.frames.push_back(frame_at(0.0, 0, 0));
  EXPECT_FALSE(fit_recording({}, one).camera_mode);
  EXPECT_FALSE(fit_recording({}, one).frame_period_s);
}

TEST(Fit, SaysNothingOfThePeriodOfTimesThatRunBackwards) {
  Streams streams;
  for (const double end_s : {100.0, 100.1, 100.2, 0.0, 0.1, 0.2})
    streams.frames.push_back(frame_at(end_s, 384, 0));
  const Fits fits = fit_recording({}, streams);
  EXPECT_FALSE(fits.frame_period_s);
  EXPECT_TRUE(fits.gaps.empty());
}

}  // namespace
}  // namespace thermorig::fit
