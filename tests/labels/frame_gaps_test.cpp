// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/labels/frame_gaps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace thermorig::labels {
namespace {

constexpr double slow_period_s = 0.1275;  // 2 % slow
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

struct Scene {
  std::vector<TimedFrame> frames;
  std::vector<int> numbers;  // of the frames that came
};

/// Frames 0..199 but those in `lost`, each seen at `seen_s(its time)`.
template <typename Seen>
Scene half_fresh_scene(const std::vector<int>& lost, Seen seen_s) {
  Scene scene;
  for (int i = 0; i < 200; ++i) {
    if (std::find(lost.begin(), lost.end(), i) != lost.end()) continue;
    const bool after_gap = !scene.numbers.empty() && scene.numbers.back() != i - 1;
    scene.frames.push_back(after_gap ? full_fresh_frame(seen_s(i * slow_period_s))
                                     : half_fresh_frame(seen_s(i * slow_period_s), i));
    scene.numbers.push_back(i);
  }
  return scene;
}

double on_time(double time_s) {
  return time_s;
}

/// A host that does not read from 5 s to 5 s + `length_s`: what queued up meanwhile comes at once.
auto stall(double length_s) {
  return [length_s](double time_s) {
    return time_s > 5.0 && time_s < 5.0 + length_s ? 5.0 + length_s + 1e-3 * (time_s - 5.0) : time_s;
  };
}

unsigned missing_in_all(const std::vector<FrameGap>& gaps) {
  unsigned total = 0;
  for (const FrameGap& gap : gaps) total += gap.missing;
  return total;
}

unsigned late_in_all(const std::vector<FrameGap>& gaps) {
  return static_cast<unsigned>(
      std::count_if(gaps.begin(), gaps.end(), [](const auto& gap) { return gap.late; }));
}

std::vector<FrameGap> live_gaps(const Scene& scene, double set_period_s, CameraMode mode) {
  LiveFrameGaps gaps(set_period_s);
  std::vector<FrameGap> result;
  HalvesOrder order;
  for (const TimedFrame& frame : scene.frames)
    result.push_back(gaps.push(frame, order.push({.even = frame.fresh_even, .odd = frame.fresh_odd}, mode)));
  return result;
}

TEST(FrameGaps, AreNoneInACompleteStream) {
  const Scene scene = half_fresh_scene({}, on_time);
  const auto gaps = find_gaps(scene.frames, slow_period_s, CameraMode::half_fresh);
  EXPECT_EQ(gaps.size(), scene.frames.size());
  EXPECT_EQ(missing_in_all(gaps), 0U);
  EXPECT_EQ(late_in_all(gaps), 0U);
}

TEST(FrameGaps, AreNoneWhereABusyHostReadsLate) {
  for (const double length_s : {0.1, 0.25, 0.6, 1.3, 2.9}) {
    const Scene scene = half_fresh_scene({}, stall(length_s));
    const auto gaps = find_gaps(scene.frames, slow_period_s, CameraMode::half_fresh);
    EXPECT_EQ(missing_in_all(gaps), 0U) << length_s;
    EXPECT_NEAR(late_in_all(gaps), (length_s - 0.5 * slow_period_s) / slow_period_s, 1.01) << length_s;
  }
}

TEST(FrameGaps, AreFoundWhereTheyAre) {
  const Scene scene = half_fresh_scene({20, 40, 41, 60, 61, 62}, on_time);
  const auto gaps = find_gaps(scene.frames, slow_period_s, CameraMode::half_fresh);
  for (std::size_t i = 1; i < gaps.size(); ++i)
    EXPECT_EQ(gaps[i].missing, scene.numbers[i] - scene.numbers[i - 1] - 1) << scene.numbers[i];
  EXPECT_EQ(late_in_all(gaps), 0U);
}

TEST(FrameGaps, AreCountedWhereAStallOverranTheBuffers) {
  const Scene scene = half_fresh_scene({50, 51, 52, 53, 54}, stall(2.5));
  EXPECT_EQ(missing_in_all(find_gaps(scene.frames, slow_period_s, CameraMode::half_fresh)), 5U);
}

TEST(FrameGaps, AreFoundByTimeAloneWhereBothHalvesAreFresh) {
  std::vector<TimedFrame> frames;
  for (const int i : {0, 1, 2, 3, 6, 7, 8, 9, 10}) frames.push_back(full_fresh_frame(i * slow_period_s));
  const auto gaps = find_gaps(frames, slow_period_s, CameraMode::full_fresh);
  EXPECT_EQ(gaps[4].missing, 2U);
  EXPECT_EQ(missing_in_all(gaps), 2U);
}

TEST(FrameGaps, AreWhereACameraPaused) {
  Scene scene = half_fresh_scene(
      {}, [](double time_s) { return time_s < 10.0 ? time_s : time_s + 10 * slow_period_s; });
  const auto gaps = find_gaps(scene.frames, slow_period_s, CameraMode::half_fresh);
  EXPECT_EQ(gaps[79].missing, 10U);  // the first frame after 10 s
  EXPECT_EQ(missing_in_all(gaps), 10U);
  EXPECT_EQ(late_in_all(gaps), 0U);
}

/// Every tenth frame comes as the one before once more; the next one then brings both halves.
Scene repeating_scene() {
  Scene scene = half_fresh_scene({}, on_time);
  for (std::size_t i = 15; i + 1 < scene.frames.size(); i += 10) {
    scene.frames[i].fresh_even = scene.frames[i].fresh_odd = 0;
    scene.frames[i + 1].fresh_even = scene.frames[i + 1].fresh_odd = half;
  }
  return scene;
}

TEST(FrameGaps, AreNoneWhereFramesRepeat) {
  EXPECT_EQ(missing_in_all(find_gaps(repeating_scene().frames, slow_period_s, CameraMode::half_fresh)), 0U);
  EXPECT_EQ(missing_in_all(live_gaps(repeating_scene(), slow_period_s, CameraMode::half_fresh)), 0U);
}

/// Halves that the bridge misses: nothing is sent for them, and the next frame brings the same half again.
Scene scene_without_halves(const std::vector<int>& lost) {
  Scene scene;
  for (int i = 0; i < 200; ++i) {
    if (std::find(lost.begin(), lost.end(), i) != lost.end()) continue;
    scene.frames.push_back(half_fresh_frame(i * slow_period_s, i));
    scene.numbers.push_back(i);
  }
  return scene;
}

/// Frames that a busy host reads so many periods late, by their numbers.
void read_late(Scene& scene, const std::vector<std::pair<int, double>>& late_periods) {
  for (const auto& [number, periods] : late_periods) {
    const auto at = std::find(scene.numbers.begin(), scene.numbers.end(), number) - scene.numbers.begin();
    scene.frames[static_cast<std::size_t>(at)].stamp.time += from_s(periods * slow_period_s);
  }
}

void expect_each_where_it_is(const Scene& scene) {
  const auto gaps = find_gaps(scene.frames, slow_period_s, CameraMode::half_fresh);
  for (std::size_t i = 1; i < gaps.size(); ++i)
    EXPECT_EQ(gaps[i].missing, scene.numbers[i] - scene.numbers[i - 1] - 1) << scene.numbers[i];
}

TEST(FrameGaps, AreWhereABridgeMissedAHalf) {
  expect_each_where_it_is(scene_without_halves({20, 40, 60, 62, 64, 66, 90}));
}

TEST(FrameGaps, AreCountedThoughReadsBeforeThemGrewLateByAndBy) {
  Scene scene = scene_without_halves({40});
  read_late(scene, {{37, 0.3}, {38, 0.58}, {39, 0.6}});
  expect_each_where_it_is(scene);
}

TEST(FrameGaps, AreWhereAHalfWasMissedThoughTheFrameBeforeItWasReadLate) {
  Scene scene = scene_without_halves({40});
  read_late(scene, {{39, 1.0}});
  expect_each_where_it_is(scene);
}

TEST(FrameGaps, AreWhereTwoHalvesWereMissedThoughTheFrameAfterThemWasReadLate) {
  Scene scene = scene_without_halves({40, 41});
  read_late(scene, {{42, 0.7}});
  expect_each_where_it_is(scene);
}

TEST(FrameGaps, AreWhereTwoHalvesWereMissedThoughTheFrameBeforeThemWasReadLate) {
  for (const double periods : {0.58, 0.9}) {
    Scene scene = scene_without_halves({40, 41, 43, 44});
    read_late(scene, {{39, periods}});
    expect_each_where_it_is(scene);
  }
}

/// A repeated frame, one with both halves after it, and then one half: which one is due nobody knows.
TEST(FrameGaps, AreWhereAHalfWasMissedAfterARepeatedFrame) {
  Scene scene = scene_without_halves({44, 46});
  scene.frames[42].fresh_even = scene.frames[42].fresh_odd = 0;
  scene.frames[43].fresh_even = scene.frames[43].fresh_odd = half;
  expect_each_where_it_is(scene);
}

TEST(FrameGaps, AreUnknownWhereTheLastFrameMayBeLateOnly) {
  Scene scene = scene_without_halves({197, 198});
  const auto gaps = find_gaps(scene.frames, slow_period_s, CameraMode::half_fresh);
  EXPECT_EQ(missing_in_all(gaps), 0U);
  EXPECT_TRUE(gaps.back().late);
}

TEST(FrameGaps, AreWhereABridgeMissedAHalfShortlyBeforeTheEnd) {
  expect_each_where_it_is(scene_without_halves({197}));
}

TEST(LiveFrameGaps, SeeAtOnceThatABridgeMissedAHalf) {
  const Scene scene = scene_without_halves({20, 40, 60, 62, 64, 66, 90});
  const auto gaps = live_gaps(scene, slow_period_s, CameraMode::half_fresh);
  for (std::size_t i = 1; i < gaps.size(); ++i) {
    EXPECT_EQ(gaps[i].missing, scene.numbers[i] - scene.numbers[i - 1] - 1) << scene.numbers[i];
    EXPECT_FALSE(gaps[i].late) << scene.numbers[i];
  }
}

TEST(LiveFrameGaps, SeeAtOnceThatABridgeThatMissesHalvesMissedTwo) {
  const Scene scene = scene_without_halves({20, 30, 40, 61, 62, 90});
  const auto gaps = live_gaps(scene, slow_period_s, CameraMode::half_fresh);
  for (std::size_t i = 1; i < gaps.size(); ++i) {
    EXPECT_EQ(gaps[i].missing, scene.numbers[i] - scene.numbers[i - 1] - 1) << scene.numbers[i];
    EXPECT_FALSE(gaps[i].late) << scene.numbers[i];
  }
}

TEST(FrameGaps, AreNoneWhereTheSameHalfComesTwiceOnTime) {
  Scene scene = half_fresh_scene({}, on_time);
  std::swap(scene.frames[50].fresh_even, scene.frames[50].fresh_odd);
  EXPECT_EQ(missing_in_all(find_gaps(scene.frames, slow_period_s, CameraMode::half_fresh)), 0U);
  EXPECT_EQ(missing_in_all(live_gaps(scene, slow_period_s, CameraMode::half_fresh)), 0U);
}

TEST(FrameGaps, AreNoneWithoutFrames) {
  EXPECT_TRUE(find_gaps({}, slow_period_s, CameraMode::half_fresh).empty());
}

TEST(LiveFrameGaps, CallALateReadLateAndNothingMissing) {
  const Scene scene = half_fresh_scene({}, stall(0.3));
  const auto gaps = live_gaps(scene, slow_period_s, CameraMode::half_fresh);
  EXPECT_EQ(missing_in_all(gaps), 0U);
  EXPECT_GT(late_in_all(gaps), 0U);
}

TEST(LiveFrameGaps, SeeALostFrameAtOnceByTheHalves) {
  const auto gaps = live_gaps(half_fresh_scene({20}, on_time), 0.125, CameraMode::half_fresh);
  EXPECT_EQ(gaps[20].missing, 1U);  // frame 21 is the 21st that came
  EXPECT_EQ(missing_in_all(gaps), 1U);
}

TEST(LiveFrameGaps, CountMissingFramesOnceTheyStayAway) {
  Scene scene;
  for (int i = 0; i < 60; ++i) scene.frames.push_back(full_fresh_frame((i < 40 ? i : i + 4) * slow_period_s));
  EXPECT_EQ(missing_in_all(live_gaps(scene, 0.125, CameraMode::full_fresh)), 4U);
}

/// Frames of a camera of 64 a second, each read when its turn comes in `reads_s`: the first at or after it.
template <typename NextRead>
Scene fast_scene(NextRead next_read_s) {
  Scene scene;
  for (int i = 0; i < 640; ++i) scene.frames.push_back(full_fresh_frame(next_read_s(i / 64.0) + 1e-5 * i));
  return scene;
}

TEST(LiveFrameGaps, CallNothingMissingThatQueuesUpForAWhile) {
  for (const double stall_s : {0.05, 0.1, 0.25, 0.7, 2.0}) {
    const auto read_s = [stall_s](double time_s) {
      return time_s > 5.0 && time_s < 5.0 + stall_s ? 5.0 + stall_s : time_s;
    };
    EXPECT_EQ(missing_in_all(live_gaps(fast_scene(read_s), 1.0 / 64.0, CameraMode::full_fresh)), 0U)
        << stall_s;
  }
}

TEST(LiveFrameGaps, CallNothingMissingWhereAllIsReadInGroups) {
  for (const double group_s : {0.03, 0.05, 0.08, 0.15}) {
    const auto read_s = [group_s](double time_s) {
      return time_s > 3.0 && time_s < 8.0 ? group_s * std::ceil(time_s / group_s) : time_s;
    };
    EXPECT_EQ(missing_in_all(live_gaps(fast_scene(read_s), 1.0 / 64.0, CameraMode::full_fresh)), 0U)
        << group_s;
  }
}

TEST(LiveFrameGaps, CallNothingMissingWhereTheSystemIsLateForAWhile) {
  const auto read_s = [](double time_s) { return time_s > 5.0 && time_s < 5.4 ? time_s + 0.15 : time_s; };
  Scene scene = fast_scene(read_s);
  for (std::size_t i = 1; i < scene.frames.size(); ++i)
    scene.frames[i].stamp.time = std::max(scene.frames[i].stamp.time, scene.frames[i - 1].stamp.time);
  EXPECT_EQ(missing_in_all(live_gaps(scene, 1.0 / 64.0, CameraMode::full_fresh)), 0U);
}

TEST(LiveFrameGaps, CountMissingFramesThatAStallOverran) {
  Scene scene = fast_scene([](double time_s) { return time_s > 5.0 && time_s < 5.5 ? 5.5 : time_s; });
  scene.frames.erase(scene.frames.begin() + 330, scene.frames.begin() + 340);  // of the 32 that came at once
  EXPECT_EQ(missing_in_all(live_gaps(scene, 1.0 / 64.0, CameraMode::full_fresh)), 10U);
}

TEST(LiveFrameGaps, LearnThePeriodOfABoardThatIsSlowerThanItsName) {
  Scene scene;
  for (int i = 0; i < 100; ++i) scene.frames.push_back(full_fresh_frame(i * 0.2551));
  const auto gaps = live_gaps(scene, 0.125, CameraMode::full_fresh);
  EXPECT_EQ(missing_in_all({gaps.begin() + 8, gaps.end()}), 0U);
}

}  // namespace
}  // namespace thermorig::labels
