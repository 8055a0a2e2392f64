// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/labels/labeller.h"

#include <gtest/gtest.h>

#include <cmath>

#include "scripted_rig.h"

namespace thermorig::labels {
namespace {

std::vector<std::uint32_t> runs(const std::vector<LabelledSample>& samples) {
  std::vector<std::uint32_t> result;
  for (const LabelledSample& sample : samples) result.push_back(sample.run);
  return result;
}

/// A frame of a live run at 100 deg/s, where nothing is known yet of the sensor but what it says; the gyro's
/// bias is, by a rest or a calibration.
LabelledSample measured_live(double measured_dps) {
  ScriptedRig rig;
  rig.gyro_dps = [](double) { return 100.0; };
  rig.measured_deg = [=](double t) { return measured_dps * t; };
  RigProfile profile;
  profile.encoder.measured_utc = "2026-07-25T14:35:12Z";
  profile.encoder.error_deg = 0.02;
  profile.servo = rig.config.servo;
  profile.gyro.bias_uncertainty_dps = 0.5;
  rig.config = label_config(profile, {}, false);
  return rig.run(4.0).at(20);
}

TEST(MeasuredLive, ASensorThatFollowsTheShaftIsBelieved) {
  const LabelledSample sample = measured_live(100.0);
  EXPECT_TRUE(sample.valid) << sample.reason_bits;
  EXPECT_NEAR(sample.rate_measured_dps, 100.0F, 0.01F);
  EXPECT_EQ(sample.rate_shaft_dps, sample.rate_measured_dps);
}

TEST(MeasuredLive, WhereAMagnetSlipsTheGyroMakesTheFrameInvalid) {
  for (const double measured_dps : {0.0, 90.0, -100.0}) {
    const LabelledSample sample = measured_live(measured_dps);
    EXPECT_TRUE(has(sample, Reason::gyro_disagrees)) << measured_dps;
    EXPECT_FALSE(sample.valid) << measured_dps;
  }
}

TEST(Runs, AreBrokenByAnInvalidFrame) {
  ScriptedRig rig;
  rig.spoil = [](TimedFrame& frame, int index) { frame.stale = index == 6; };
  EXPECT_EQ(runs(rig.run(1.26)), (std::vector<std::uint32_t>{0, 0, 0, 1, 1, 1, 0, 2, 2, 2}));
}

TEST(Runs, LieInOneLeg) {
  ScriptedRig rig;
  rig.leg = [](double t) { return t < 0.8 ? 4 : 5; };
  rig.spoil = [](TimedFrame& frame, int) { frame.exposure_begin = frame.exposure_end - from_s(0.04); };
  const auto samples = rig.run(1.26);
  EXPECT_EQ(runs(samples), (std::vector<std::uint32_t>{0, 1, 1, 1, 1, 1, 2, 2, 2, 2}));
  EXPECT_EQ(samples[5].leg, 4);
  EXPECT_EQ(samples[6].leg, 5);
}

TEST(Runs, AreBrokenByALostFrame) {
  ScriptedRig rig;
  rig.spoil = [](TimedFrame& frame, int index) { frame.missing_before = index == 6 ? 1 : 0; };
  const auto samples = rig.run(1.26);
  EXPECT_EQ(runs(samples), (std::vector<std::uint32_t>{0, 0, 0, 1, 1, 1, 2, 2, 2, 2}));
  EXPECT_TRUE(samples[6].valid);  // what came is as good as ever
}

TEST(GyroGap, IsWhereASampleThatTheFrameWouldHaveHadNeverCame) {
  ScriptedRig rig;
  const double stolen_s = 0.8;
  rig.gyro_comes = [&](double t) { return std::abs(t - stolen_s) > 0.003; };
  rig.config.gyro_gaps = {{at_s(stolen_s - 0.005), at_s(stolen_s + 0.005), 1}};
  int gaps = 0;
  for (const LabelledSample& sample : rig.run(1.26)) {
    const bool is_there =
        seconds(sample.exposure_begin) <= stolen_s && stolen_s < seconds(sample.exposure_end);
    EXPECT_EQ((sample.reason_bits & bit(Reason::gyro_gap)) != 0, is_there) << sample.frame_index;
    EXPECT_FALSE(is_there && sample.valid);
    gaps += is_there ? 1 : 0;
  }
  EXPECT_GE(gaps, 1);
}

TEST(GyroGap, OfTenSamplesAndMoreIsSeenByTheRunningRecorder) {
  ScriptedRig rig;
  rig.gyro_comes = [](double t) { return t < 0.7975 || t > 0.8625; };  // 13 of 25: more than half come
  int gaps = 0;
  for (const LabelledSample& sample : rig.run(1.26)) {
    const bool is_there = seconds(sample.exposure_begin) <= 0.86 && 0.8 < seconds(sample.exposure_end);
    EXPECT_EQ((sample.reason_bits & bit(Reason::gyro_gap)) != 0, is_there) << sample.frame_index;
    gaps += is_there ? 1 : 0;
  }
  EXPECT_GE(gaps, 1);
}

TEST(GyroGap, CountsThoseThatWouldStandEvenlyInIt) {
  const std::vector<ClockGap> gaps{{at_s(1.0), at_s(1.4), 3}, {at_s(2.0), at_s(2.5), 0}};  // at 1.1, 1.2, 1.3
  EXPECT_FALSE(lacks_sample(gaps, at_s(0.9), at_s(1.05)));
  EXPECT_TRUE(lacks_sample(gaps, at_s(0.9), at_s(1.15)));
  EXPECT_TRUE(lacks_sample(gaps, at_s(1.15), at_s(1.25)));
  EXPECT_FALSE(lacks_sample(gaps, at_s(1.21), at_s(1.29)));
  EXPECT_FALSE(lacks_sample(gaps, at_s(1.35), at_s(2.4)));
  EXPECT_FALSE(lacks_sample({}, at_s(1.0), at_s(2.0)));
}

TEST(Labeller, GivesEveryFrameOnceAndInOrder) {
  const auto samples = ScriptedRig().run(10.0);
  ASSERT_EQ(samples.size(), 80U);
  for (std::size_t i = 0; i < samples.size(); ++i) EXPECT_EQ(samples[i].frame_index, i);
}

TEST(Labeller, HoldsAFrameUntilTelemetryAndGyroPassItsExposure) {
  const ScriptedRig rig;
  Labeller labeller(rig.config);
  labeller.add(rig.frame_at(1.0, 0));
  EXPECT_TRUE(labeller.take(at_s(1.1)).empty());
  labeller.add(rig.servo_at(1.01));
  labeller.add(rig.servo_at(1.02));
  EXPECT_TRUE(labeller.take(at_s(1.2)).empty());
  labeller.add(rig.gyro_at(0.999));
  EXPECT_TRUE(labeller.take(at_s(1.3)).empty());
  labeller.add(rig.gyro_at(1.004));
  EXPECT_EQ(labeller.take(at_s(1.4)).size(), 1U);
  EXPECT_TRUE(labeller.take(at_s(9.0)).empty());
}

TEST(Labeller, LetsAFrameGoWithoutAfterWaitingLongEnough) {
  const ScriptedRig rig;
  Labeller labeller(rig.config);
  labeller.add(rig.frame_at(1.0, 0));
  EXPECT_TRUE(labeller.take(at_s(1.99)).empty());
  const auto samples = labeller.take(at_s(2.0));
  ASSERT_EQ(samples.size(), 1U);
  EXPECT_TRUE(std::isnan(samples[0].rate_shaft_dps));
  EXPECT_TRUE(has(samples[0], Reason::servo_lost));
  EXPECT_TRUE(has(samples[0], Reason::gyro_gap));
}

TEST(Labeller, UsesTelemetryThatComesLate) {
  const ScriptedRig rig;
  Labeller labeller(rig.config);
  labeller.add(rig.frame_at(1.0, 0));
  for (double t = 0.5; t < 1.1; t += 0.005) labeller.add(rig.gyro_at(t));
  EXPECT_TRUE(labeller.take(at_s(1.1)).empty());
  for (double t = 0.5; t < 1.1; t += 0.01) labeller.add(rig.servo_at(t));  // all in one read
  const auto samples = labeller.take(at_s(1.7));
  ASSERT_EQ(samples.size(), 1U);
  EXPECT_TRUE(samples[0].valid);
}

TEST(Labeller, LabelsAHalfAnewThatHadToGoWithoutInTheFrameBefore) {
  const ScriptedRig rig;
  Labeller labeller(rig.config);
  labeller.add(rig.frame_at(1.0, 0));
  const auto without = labeller.take(at_s(2.0));
  ASSERT_EQ(without.size(), 1U);
  EXPECT_TRUE(std::isnan(without[0].rate_gyro_half_dps[0]));
  for (double t = 0.5; t < 1.2; t += 0.005) labeller.add(rig.gyro_at(t));
  for (double t = 0.5; t < 1.2; t += 0.01) labeller.add(rig.servo_at(t));
  labeller.add(rig.frame_at(1.125, 1));
  const auto samples = labeller.take(at_s(2.1));
  ASSERT_EQ(samples.size(), 1U);
  EXPECT_NEAR(samples[0].rate_gyro_half_dps[0], 101.5, 1e-3);
  EXPECT_NEAR(samples[0].rate_commanded_half_dps[0], 100.0, 0.1);
}

// What a half shows is no less certain for being shown long after: telemetry and samples of its exposure are
// forgotten by then, its label is not. The frame, which shows it beside a fresh half, has none: it spans
// both.
TEST(Labeller, KeepsTheLabelOfAHalfThatIsShownAgainAndAgain) {
  ScriptedRig rig;
  const HalfExposure lost{at_s(0.875), at_s(1.0)};
  rig.spoil = [&](TimedFrame& frame, int index) {
    if (index < 8) return;
    frame.half_lost = true;
    frame.half = {lost, {frame.exposure_end - from_s(rig.frame_period_s), frame.exposure_end}};
  };
  rig.telemetry_comes = [](double t) { return t < 10.0 || t > 12.5; };  // frames go without in between
  ASSERT_LT(rig.config.history_s, 11.0);
  const auto samples = rig.run(14.0);
  for (const std::size_t frame : {std::size_t{8}, samples.size() - 1}) {
    EXPECT_NEAR(samples[frame].rate_commanded_half_dps[0], 100.0, 0.1) << frame;
    EXPECT_NEAR(samples[frame].rate_gyro_half_dps[0], 101.5, 1e-3) << frame;
    EXPECT_NEAR(samples[frame].rate_shaft_half_dps[0], 100.0, 3.0) << frame;
  }
  EXPECT_TRUE(samples[8].valid);
  EXPECT_FALSE(samples.back().valid);
  EXPECT_TRUE(has(samples.back(), Reason::servo_lost));
  EXPECT_TRUE(std::isnan(samples.back().rate_commanded_dps));
}

TEST(Labeller, AWaitingFrameHoldsBackTheOnesBehindIt) {
  const ScriptedRig rig;
  Labeller labeller(rig.config);
  TimedFrame late = rig.frame_at(5.0, 0);
  late.stamp.arrival = at_s(1.0);
  labeller.add(late);
  labeller.add(rig.frame_at(1.0, 1));
  labeller.add(rig.servo_at(1.01));
  labeller.add(rig.gyro_at(1.01));
  EXPECT_TRUE(labeller.take(at_s(1.2)).empty());
  const auto samples = labeller.finish();
  ASSERT_EQ(samples.size(), 2U);
  EXPECT_EQ(samples[0].frame_index, 0U);
  EXPECT_EQ(samples[1].frame_index, 1U);
}

TEST(Labeller, ToleratesTelemetryThatRunsBackwards) {
  ScriptedRig rig;
  Labeller labeller(rig.config);
  for (int i = 0; i < 200; ++i) {
    const double t = 0.01 * i;
    labeller.add(rig.servo_at(i % 10 == 9 ? t - 0.03 : t));
    labeller.add(rig.gyro_at(t));
  }
  labeller.add(rig.frame_at(1.0, 0));
  const auto samples = labeller.finish();
  ASSERT_EQ(samples.size(), 1U);
  EXPECT_NEAR(samples[0].rate_shaft_dps, 100.0, 3.0);
}

TEST(Labeller, LabelsAnExposureWithoutLength) {
  ScriptedRig rig;
  rig.offset_s = 0.0;  // telemetry at the very instant
  rig.spoil = [](TimedFrame& frame, int) { frame.exposure_begin = frame.exposure_end; };
  const auto samples = rig.run(2.0);
  EXPECT_NEAR(samples[7].rate_commanded_dps, 100.0, 1e-2);
  EXPECT_TRUE(std::isnan(samples[7].rate_shaft_dps));  // no time, no turn
  EXPECT_FALSE(samples[7].valid);
}

TEST(History, ForgetsWhatIsOlderThanItsLength) {
  struct Point {
    HostTime time{};
  };
  History<Point> history(from_s(10.0));
  for (int i = 0; i < 100'000; ++i) history.add({at_s(0.01 * i)});
  EXPECT_EQ(history.all().size(), 1001U);
  EXPECT_EQ(history.all().front().time, at_s(989.99));
  EXPECT_TRUE(history.reaches(at_s(999.99)));
  EXPECT_FALSE(history.reaches(at_s(1000.0)));
}

}  // namespace
}  // namespace thermorig::labels
