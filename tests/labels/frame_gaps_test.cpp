// SPDX-License-Identifier: MIT
#include "thermorig/labels/frame_gaps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace thermorig::labels {
namespace {

constexpr double period_s = 0.1275;  // 2 % slow
constexpr std::uint16_t half = 384;

TimedFrame half_fresh_frame(double time_s, int index) {
  TimedFrame frame;
  frame.stamp.time = host_time_ns(0) + from_s(time_s);
  frame.fresh_even = index % 2 == 0 ? half : 0;
  frame.fresh_odd = index % 2 == 0 ? 0 : half;
  return frame;
}

TimedFrame full_fresh_frame(double time_s) {
  TimedFrame frame = half_fresh_frame(time_s, 0);
  frame.fresh_odd = half;
  return frame;
}

/// Frames 0..99 but those in `lost`, each `late_s(index)` late; what FrameGaps says of each that came.
template <typename Late>
std::vector<unsigned> half_fresh_gaps(FrameGaps gaps, const std::vector<int>& lost, Late late_s) {
  std::vector<unsigned> found;
  for (int i = 0; i < 100; ++i)
    if (std::find(lost.begin(), lost.end(), i) == lost.end())
      found.push_back(gaps.push(half_fresh_frame(i * period_s + late_s(i), i), CameraMode::half_fresh));
  return found;
}

unsigned sum(const std::vector<unsigned>& counts) {
  unsigned total = 0;
  for (const unsigned count : counts) total += count;
  return total;
}

TEST(FrameGaps, FindsNothingInACompleteStream) {
  EXPECT_EQ(sum(half_fresh_gaps(FrameGaps(period_s, true), {}, [](int) { return 0.0; })), 0U);
}

TEST(FrameGaps, TakesALateReadForWhatItIs) {
  const auto late_s = [](int i) { return i % 7 == 3 ? 0.11 : 0.0; };
  EXPECT_EQ(sum(half_fresh_gaps(FrameGaps(period_s, true), {}, late_s)), 0U);
}

TEST(FrameGaps, FindsOneTwoAndThreeLostFrames) {
  const auto found =
      half_fresh_gaps(FrameGaps(period_s, true), {20, 40, 41, 60, 61, 62}, [](int) { return 0.0; });
  EXPECT_EQ(found[20], 1U);  // frame 21 is the 21st that came
  EXPECT_EQ(found[39], 2U);  // frame 42
  EXPECT_EQ(found[57], 3U);  // frame 63
  EXPECT_EQ(sum(found), 6U);
}

TEST(FrameGaps, FindsALostFrameBesideALateOne) {
  const auto late_s = [](int i) { return i == 19 ? 0.1 : 0.0; };  // so that frame 21 seems to come early
  EXPECT_EQ(half_fresh_gaps(FrameGaps(period_s, true), {20}, late_s)[20], 1U);
}

TEST(FrameGaps, LearnsThePeriodWhereOnlyANominalOneIsKnown) {
  FrameGaps gaps(0.125, false);  // an "8 Hz" board that sends 3.92 whole frames a second
  unsigned missing = 0;
  for (int i = 0; i < 100; ++i) {
    const unsigned count = gaps.push(full_fresh_frame(i * 0.2551), CameraMode::full_fresh);
    if (i >= 6) missing += count;
  }
  EXPECT_EQ(missing, 0U);
}

TEST(FrameGaps, FindsLostWholeFramesByTimeAlone) {
  FrameGaps gaps(period_s, true);
  std::vector<unsigned> found;
  for (const int i : {0, 1, 2, 3, 6, 7, 8})
    found.push_back(gaps.push(full_fresh_frame(i * period_s), CameraMode::full_fresh));
  EXPECT_EQ(found, (std::vector<unsigned>{0, 0, 0, 0, 2, 0, 0}));
}

}  // namespace
}  // namespace thermorig::labels
