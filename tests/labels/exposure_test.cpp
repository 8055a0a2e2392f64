// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/labels/exposure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace thermorig::labels {
namespace {

constexpr double nominal_s = 0.125;

/// Frames with chosen fresh halves: 'E', 'O', 'B'oth or 'N'one, each a frame period after the one before.
class FrameMaker {
 public:
  TimedFrame next(char fresh) {
    time_ += from_s(nominal_s);
    TimedFrame timed;
    if (fresh == 'E' || fresh == 'B') timed.fresh_even = 384;
    if (fresh == 'O' || fresh == 'B') timed.fresh_odd = 384;
    timed.stamp.time = time_;
    return timed;
  }

 private:
  HostTime time_{};
};

/// What the rule says of a sequence of frames: 's'tale or 'f'resh.
std::string staleness(ExposureRule rule, const std::string& sequence) {
  FrameMaker maker;
  std::string result;
  for (const char fresh : sequence) {
    TimedFrame frame = maker.next(fresh);
    rule.apply(frame);
    result += frame.stale ? 's' : 'f';
  }
  return result;
}

TEST(ExposureRule, AHalfFreshFrameSpansTwoFramePeriods) {
  ExposureRule rule(nominal_s, CameraMode::half_fresh);
  TimedFrame frame = FrameMaker().next('B');
  frame.stamp.time = HostTime(from_s(7.0));
  rule.apply(frame);
  EXPECT_EQ(frame.exposure_end, HostTime(from_s(7.0)));
  EXPECT_EQ(frame.exposure_begin, HostTime(from_s(6.75)));
}

TEST(ExposureRule, AFullFreshFrameSpansTwoRefreshPeriodsOfHalfTheLength) {
  ExposureRule rule(nominal_s, CameraMode::full_fresh);
  TimedFrame frame = FrameMaker().next('B');
  frame.stamp.time = HostTime(from_s(7.0));
  rule.apply(frame);
  EXPECT_EQ(frame.exposure_end, HostTime(from_s(7.0)));
  EXPECT_EQ(frame.exposure_begin, HostTime(from_s(6.875)));
}

TEST(ExposureRule, AlternatingHalvesAreFreshInHalfFreshMode) {
  EXPECT_EQ(staleness(ExposureRule(nominal_s, CameraMode::half_fresh), "BEOEOE"), "ffffff");
}

TEST(ExposureRule, ARepeatedFrameIsStaleInEitherMode) {
  EXPECT_EQ(staleness(ExposureRule(nominal_s, CameraMode::half_fresh), "BENOE"), "ffsff");
  EXPECT_EQ(staleness(ExposureRule(nominal_s, CameraMode::full_fresh), "BBNB"), "ffsf");
}

TEST(ExposureRule, TheSameHalfTwiceInARowIsStaleInHalfFreshMode) {
  EXPECT_EQ(staleness(ExposureRule(nominal_s, CameraMode::half_fresh), "BEOOEE"), "fffsfs");
}

TEST(ExposureRule, TheSameHalfTwiceIsStaleEvenWithARepeatedFrameBetween) {
  EXPECT_EQ(staleness(ExposureRule(nominal_s, CameraMode::half_fresh), "BENEO"), "ffssf");
}

TEST(ExposureRule, EitherHalfMayFollowAFrameThatBroughtBoth) {
  EXPECT_EQ(staleness(ExposureRule(nominal_s, CameraMode::half_fresh), "BEBEBO"), "ffffff");
}

TEST(ExposureRule, ASingleHalfIsStaleInFullFreshMode) {
  EXPECT_EQ(staleness(ExposureRule(nominal_s, CameraMode::full_fresh), "BBEBO"), "ffsfs");
}

TEST(ExposureRule, DecidesTheModeFromTheFramesSoFar) {
  ExposureRule rule(nominal_s);
  FrameMaker maker;
  std::string modes;
  for (const char fresh : std::string("BEOBBBN")) {
    TimedFrame frame = maker.next(fresh);
    rule.apply(frame);
    const bool half = rule.mode() == CameraMode::half_fresh;
    modes += half ? 'h' : 'f';
    EXPECT_EQ(frame.exposure_end - frame.exposure_begin, from_s(half ? 2 * nominal_s : nominal_s));
  }
  EXPECT_EQ(modes, "hhhhhff");
}

TEST(ExposureRule, TheFirstFrameDoesNotDecideTheMode) {
  ExposureRule rule(nominal_s);
  TimedFrame frame = FrameMaker().next('B');
  rule.apply(frame);
  EXPECT_EQ(rule.mode(), CameraMode::half_fresh);
}

/// Exposure of the even and the odd half of the last of a sequence of frames, in periods before its end:
/// begin and end, e.g. "2..1 1..0".
std::string halves(ExposureRule rule, const std::string& sequence, double jitter_s = 0.0) {
  FrameMaker maker;
  TimedFrame frame;
  for (const char fresh : sequence) {
    frame = maker.next(fresh);
    frame.stamp.time += from_s(jitter_s);
    jitter_s = -jitter_s;
    rule.apply(frame);
  }
  const auto ago = [&](HostTime time) {
    return std::to_string(std::lround(2.0 * to_s(frame.exposure_end - time) / nominal_s));  // half periods
  };
  std::string result;
  for (const HalfExposure& half : frame.half) result += ago(half.begin) + ".." + ago(half.end) + " ";
  return result;
}

TEST(ExposureRule, TheFreshHalfWasExposedLast) {
  EXPECT_EQ(halves(ExposureRule(nominal_s, CameraMode::half_fresh), "BEOE"), "2..0 4..2 ");
  EXPECT_EQ(halves(ExposureRule(nominal_s, CameraMode::half_fresh), "BEOEO"), "4..2 2..0 ");
}

TEST(ExposureRule, AHalfThatIsNotFreshKeepsItsLastExposure) {
  EXPECT_EQ(halves(ExposureRule(nominal_s, CameraMode::half_fresh), "BEOEE"), "2..0 6..4 ");
  EXPECT_EQ(halves(ExposureRule(nominal_s, CameraMode::half_fresh), "BEON"), "6..4 4..2 ");
  EXPECT_EQ(halves(ExposureRule(nominal_s, CameraMode::full_fresh, 1U), "BBE"), "2..1 3..2 ");
}

TEST(ExposureRule, AfterAMissingFrameTheOrderFollowsFromTheTime) {
  ExposureRule rule(nominal_s, CameraMode::half_fresh);
  FrameMaker maker;
  for (const char fresh : std::string("BEOE")) {
    TimedFrame frame = maker.next(fresh);
    rule.apply(frame);
  }
  (void)maker.next('O');  // never came
  TimedFrame frame = maker.next('B');
  rule.apply(frame);
  EXPECT_EQ(frame.half[0].end, frame.exposure_end);
  EXPECT_EQ(frame.half[1].end, frame.exposure_end - from_s(nominal_s));
}

TEST(ExposureRule, OfAFullFreshFrameTheNewerHalfTakesTheLaterPeriod) {
  EXPECT_EQ(halves(ExposureRule(nominal_s, CameraMode::full_fresh, 0U), "BBB"), "1..0 2..1 ");
  EXPECT_EQ(halves(ExposureRule(nominal_s, CameraMode::full_fresh, 1U), "BBB"), "2..1 1..0 ");
}

TEST(ExposureRule, WhereTheOrderIsUnknownBothHalvesGetTheWholeSpan) {
  EXPECT_EQ(halves(ExposureRule(nominal_s, CameraMode::full_fresh), "BBB"), "2..0 2..0 ");
  EXPECT_EQ(halves(ExposureRule(nominal_s, CameraMode::half_fresh), "B"), "4..0 4..0 ");
}

}  // namespace
}  // namespace thermorig::labels
