// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "scripted_rig.h"

namespace thermorig::labels {
namespace {

/// Ends of exposure, in frame periods, of the samples that carry `reason`.
std::vector<int> frames_with(Reason reason, const std::vector<LabelledSample>& samples) {
  std::vector<int> frames;
  for (const LabelledSample& sample : samples)
    if (has(sample, reason)) frames.push_back(static_cast<int>(sample.frame_index));
  return frames;
}

/// Frames i = first .. last whose exposure [(i - 1) P, (i + 1) P], begun `earlier_s` earlier, meets [from,
/// to].
std::vector<int> frames_meeting(double from_time, double to_time, double earlier_s, int frames) {
  std::vector<int> result;
  for (int i = 0; i < frames; ++i)
    if ((i - 1) * 0.125 - earlier_s < to_time && (i + 1) * 0.125 > from_time) result.push_back(i);
  return result;
}

/// Frames that start before telemetry does, with the settling time: they can not be covered.
constexpr int uncovered = 3;

std::vector<int> without_start(std::vector<int> frames) {
  std::erase_if(frames, [](int i) { return i < uncovered; });
  return frames;
}

TEST(Reasons, NoneForASteadySweep) {
  const auto samples = ScriptedRig().run(3.0);
  ASSERT_EQ(samples.size(), 24U);
  for (std::size_t i = uncovered; i < samples.size() - 1; ++i) EXPECT_EQ(samples[i].reason_bits, 0U) << i;
}

TEST(Reasons, CameraGapIsWhereFramesAreMissing) {
  ScriptedRig rig;
  rig.spoil = [](TimedFrame& frame, int index) { frame.missing_before = index == 12 ? 2 : 0; };
  EXPECT_EQ(frames_with(Reason::camera_gap, rig.run(3.0)), std::vector<int>{12});
}

/// One of its halves is the one before that which was lost: the label is over all that the frame shows.
TEST(Reasons, AFrameThatLacksTheHalfThatWasDueIsLabelledOverBothThatItShows) {
  ScriptedRig rig;
  bool is_ramp = false;
  rig.rate_dps = [&](double t) { return is_ramp && t < 1.3 ? 50.0 : 100.0; };
  rig.gyro_dps = rig.rate_dps;
  rig.spoil = [](TimedFrame& frame, int index) {
    if (index != 12) return;
    frame.stale = frame.half_lost = true;
    frame.half[0] = {frame.exposure_end - from_s(0.375), frame.exposure_end - from_s(0.25)};
    frame.half[1] = {frame.exposure_end - from_s(0.125), frame.exposure_end};
  };
  const auto samples = rig.run(3.0);
  EXPECT_EQ(frames_with(Reason::camera_gap, samples), std::vector<int>{12});
  EXPECT_TRUE(samples[12].valid);
  EXPECT_EQ(samples[12].exposure_end - samples[12].exposure_begin, from_s(0.375));
  EXPECT_EQ(samples[12].exposure_end - samples[12].time, samples[11].exposure_end - samples[11].time);
  EXPECT_EQ(samples[12].run, samples[11].run + 1);
  is_ramp = true;  // within what the older half saw, and before what the newer did
  EXPECT_FALSE(rig.run(3.0)[12].valid);
}

TEST(Reasons, TelemetryThatABusyHostReadsLateIsNotLost) {
  LabelConfig config;
  Labeller labeller(config);
  ScriptedRig rig;
  for (int i = 0; i < 200; ++i) {
    TimedServo servo = rig.servo_at(0.01 * i);
    if (i > 100 && i <= 118)
      servo.stamp.time = at_s(1.18);  // a stall of 180 ms; the servo's own clock runs on
    labeller.add(servo);
    labeller.add(rig.gyro_at(0.01 * i));
    labeller.add(rig.gyro_at(0.01 * i + 0.005));
  }
  labeller.add(rig.frame_at(1.3, 0));
  EXPECT_FALSE(has(labeller.finish().front(), Reason::servo_lost));
}

TEST(Reasons, CameraNotFreshAndChecksumComeWithTheFrame) {
  ScriptedRig rig;
  rig.spoil = [](TimedFrame& frame, int index) {
    frame.stale = index == 9;
    frame.resync_before = index == 11;
  };
  const auto samples = rig.run(3.0);
  EXPECT_EQ(frames_with(Reason::camera_not_fresh, samples), std::vector<int>{9});
  EXPECT_EQ(frames_with(Reason::checksum, samples), std::vector<int>{11});
  EXPECT_FALSE(samples[9].valid);
  EXPECT_FALSE(samples[11].valid);
  EXPECT_EQ(samples[9].first_reason(), 2);
}

TEST(Reasons, OutOfRangeIsAnyPixelBeyondTheSensorsRange) {
  ScriptedRig rig;
  rig.spoil = [](TimedFrame& frame, int index) {
    if (index == 5) frame.frame.temp_c[700] = -60.5F;
    if (index == 6) frame.frame.temp_c[0] = 400.5F;
    if (index == 7) frame.frame.temp_c[767] = std::numeric_limits<float>::quiet_NaN();
    if (index == 8) frame.frame.temp_c[3] = -60.0F;
    if (index == 9) frame.frame.temp_c[3] = 400.0F;
  };
  EXPECT_EQ(frames_with(Reason::out_of_range, rig.run(3.0)), (std::vector<int>{5, 6, 7}));
}

TEST(Reasons, ServoRampWhereTheModelLeavesTheCommandedSpeed) {
  ScriptedRig rig;
  rig.rate_dps = [](double t) { return std::clamp(100.0 + (t - 1.45) * 1000.0, 100.0, 130.0); };
  const auto samples = rig.run(4.0);
  // Frame 14 is exposed from 1.625 on, when the loop of 8 Hz has settled to 2 %.
  EXPECT_EQ(without_start(frames_with(Reason::servo_ramp, samples)), (std::vector<int>{11, 12, 13, 31}));
}

TEST(Reasons, ServoRampSpareAnExposureThatEndsBeforeTheShaftFollows) {
  ScriptedRig rig;
  rig.rate_dps = [](double t) { return t < 1.49 ? 100.0 : 0.0; };
  const auto ramps = frames_with(Reason::servo_ramp, rig.run(4.0));
  EXPECT_FALSE(std::count(ramps.begin(), ramps.end(), 10));
  EXPECT_TRUE(std::count(ramps.begin(), ramps.end(), 12));
}

TEST(Reasons, ServoRampToleratesWhatTheConfigurationSays) {
  for (const double step_dps : {1.9, 4.0}) {
    ScriptedRig rig;
    rig.rate_dps = [step_dps](double t) { return t < 1.5 ? 100.0 : 100.0 + step_dps; };
    const auto ramps = without_start(frames_with(Reason::servo_ramp, rig.run(3.0)));
    EXPECT_EQ(std::count(ramps.begin(), ramps.end(), 12) > 0, step_dps > 2.0) << step_dps;
  }
}

TEST(Reasons, ServoLostWhereTelemetryHasAHole) {
  ScriptedRig rig;
  rig.telemetry_comes = [](double t) { return t < 1.4 || t > 1.46; };
  // the last before is 1.3913, the first after 1.4613
  const auto lost = without_start(frames_with(Reason::servo_lost, rig.run(4.0)));
  auto expected = frames_meeting(1.3913, 1.4613, 0.2, 32);
  expected.push_back(31);  // no telemetry after the last frame's exposure
  EXPECT_EQ(lost, expected);
}

TEST(Reasons, ServoLostNotForASmallHole) {
  ScriptedRig rig;
  rig.telemetry_comes = [](double t) { return t < 1.4 || t > 1.44; };  // 50 ms between neighbours
  const auto lost = without_start(frames_with(Reason::servo_lost, rig.run(4.0)));
  EXPECT_EQ(lost, std::vector<int>{31});
}

TEST(Reasons, ServoLostWhileDisarmedOrAtFault) {
  for (const bool disarmed : {false, true}) {
    ScriptedRig rig;
    const auto bad = [](double t) { return t > 1.495 && t < 1.505; };  // one message, at 1.5013
    if (disarmed)
      rig.motion = [bad](double t) { return bad(t) ? ServoMotion::disarmed : ServoMotion::steady; };
    else
      rig.fault = [bad](double t) { return bad(t) ? ServoFault::watchdog : ServoFault::none; };
    auto expected = frames_meeting(1.4913, 1.5113, 0.2, 32);  // in the span, or next to it
    expected.push_back(31);
    EXPECT_EQ(without_start(frames_with(Reason::servo_lost, rig.run(4.0))), expected);
  }
}

TEST(Reasons, AServoThatComesToRestIsARampNotALoss) {
  ScriptedRig rig;
  rig.rate_dps = [](double t) { return std::clamp(100.0 - (t - 1.45) * 2000.0, 0.0, 100.0); };
  rig.motion = [](double t) { return t < 1.45 ? ServoMotion::steady : ServoMotion::stopping; };
  const auto samples = rig.run(4.0);
  EXPECT_EQ(without_start(frames_with(Reason::servo_lost, samples)), std::vector<int>{31});
  const auto ramps = without_start(frames_with(Reason::servo_ramp, samples));
  const std::vector<int> least{11, 12, 13};
  EXPECT_TRUE(std::includes(ramps.begin(), ramps.end(), least.begin(), least.end()));
  EXPECT_LE(ramps.size(), 5U);  // 14 is on the edge, and the last has no telemetry after it
}

TEST(Reasons, LimitHitWithinTheMarginOfEitherEndOfTheTravel) {
  ScriptedRig rig;
  rig.config.travel_deg = 180.0;
  rig.config.stop_margin_deg = 2.0;
  for (const double sign : {-1.0, 1.0}) {
    rig.angle_deg = [sign](double t) { return sign * (t > 1.6 && t < 1.605 ? 88.1 : 87.9); };
    const auto hit = frames_with(Reason::limit_hit, rig.run(4.0));
    EXPECT_EQ(hit, frames_meeting(1.5913, 1.6113, 0.0, 32));
  }
}

TEST(Reasons, LimitHitNotForAContinuousServo) {
  ScriptedRig rig;
  rig.config.travel_deg = 0.0;
  rig.angle_deg = [](double t) { return 1000.0 * t; };
  EXPECT_TRUE(frames_with(Reason::limit_hit, rig.run(3.0)).empty());
}

TEST(Reasons, ReversalWhereTheShaftTurnsBackInTheExposure) {
  ScriptedRig rig;
  rig.rate_dps = [](double t) { return std::clamp((t - 1.45) * -2000.0, -100.0, 100.0); };
  const auto samples = rig.run(4.0);
  // The command turns at 1.45, the shaft about 45 ms later.
  const auto turns = frames_with(Reason::reversal, samples);
  EXPECT_TRUE(std::count(turns.begin(), turns.end(), 12));
  for (const int frame : turns) {
    EXPECT_TRUE(frame >= 11 && frame <= 13) << frame;
    EXPECT_TRUE(has(samples[static_cast<std::size_t>(frame)], Reason::servo_ramp));
  }
}

TEST(Reasons, ReversalNotForAStartFromRest) {
  ScriptedRig rig;
  rig.rate_dps = [](double t) { return t < 1.5 ? 0.0 : -50.0; };
  EXPECT_TRUE(frames_with(Reason::reversal, rig.run(3.0)).empty());
}

TEST(Reasons, OutsideLegWhereAnyTelemetryOfTheExposureHasNoLeg) {
  ScriptedRig rig;
  rig.leg = [](double t) { return t < 1.5 ? 0 : 3; };
  const auto samples = rig.run(4.0);
  EXPECT_EQ(frames_with(Reason::outside_leg, samples), frames_meeting(0.0, 1.5013, 0.0, 32));
  EXPECT_TRUE(frames_with(Reason::leg_change, samples).empty());
}

TEST(Reasons, ARestIsOutsideALegAndNotValid) {
  ScriptedRig rig;
  rig.leg = [](double) { return 0; };
  rig.rate_dps = [](double) { return 0.0; };
  rig.gyro_dps = [](double) { return 1.5; };
  rig.motion = [](double) { return ServoMotion::holding; };
  const auto samples = rig.run(2.0);
  for (std::size_t i = uncovered; i < samples.size() - 1; ++i) {
    EXPECT_EQ(samples[i].reason_bits, bit(Reason::outside_leg)) << i;
    EXPECT_NEAR(samples[i].rate_shaft_dps, 0.0F, 1e-3F);
    EXPECT_FALSE(samples[i].valid);
    EXPECT_EQ(samples[i].run, 0U);
  }
}

TEST(Reasons, LegChangeWhereTheExposureLiesInTwoLegs) {
  ScriptedRig rig;
  rig.leg = [](double t) { return t < 1.5 ? 2 : 3; };
  const auto samples = rig.run(4.0);
  // What the shaft shows is one pulse period and the delay old.
  constexpr double lag_s = 0.025;
  EXPECT_EQ(frames_with(Reason::leg_change, samples),
            frames_meeting(1.4913 + lag_s, 1.5013 + lag_s, 0.0, 32));
  EXPECT_TRUE(frames_with(Reason::outside_leg, samples).empty() ||
              frames_with(Reason::outside_leg, samples).front() < uncovered);
}

TEST(Reasons, GyroGapBelowHalfOfTheExpectedSamples) {
  for (const bool one_more : {false, true}) {  // frame 8 is exposed from 0.875 to 1.125
    ScriptedRig rig;
    rig.gyro_comes = [&rig, one_more](double t) {
      const auto number = std::lround((t - rig.offset_s) / rig.gyro_s);
      return number % 2 == 0 && !(one_more && number == 200);
    };
    const LabelledSample sample = rig.run(4.0).at(8);
    EXPECT_EQ(sample.gyro_count, one_more ? 24 : 25);
    EXPECT_EQ(has(sample, Reason::gyro_gap), one_more);
  }
}

TEST(Reasons, WithoutAGyroTheMeanIsNotANumber) {
  ScriptedRig rig;
  rig.gyro_comes = [](double) { return false; };
  for (const LabelledSample& sample : rig.run(1.0)) {
    EXPECT_TRUE(std::isnan(sample.rate_gyro_dps));
    EXPECT_EQ(sample.gyro_count, 0);
    EXPECT_TRUE(has(sample, Reason::gyro_gap));
  }
}

TEST(Reasons, OnlyThoseThatThisVersionSaysItComputesAreEverSet) {
  ScriptedRig rig;
  rig.rate_dps = [](double t) { return 200.0 * std::sin(3.0 * t); };
  rig.leg = [](double t) { return static_cast<int>(t) % 3; };
  rig.angle_deg = [](double t) { return 2000.0 * std::cos(t); };
  rig.telemetry_comes = [](double t) { return std::fmod(t, 1.7) > 0.1; };
  rig.gyro_comes = [](double t) { return std::fmod(t, 2.3) > 0.3; };
  rig.gyro_dps = [](double t) { return t < 10.0 ? 500.0 : 100.0 * std::sin(30.0 * t); };
  rig.spoil = [](TimedFrame& frame, int index) {
    frame.stale = index % 5 == 0;
    frame.resync_before = index % 7 == 0;
    if (index % 11 == 0) frame.frame.temp_c[0] = 500.0F;
    frame.missing_before = index % 13 == 0 ? 1 : 0;
    frame.late = index % 17 == 0;
    frame.frame.sensor_temp_c = 30.0F + 0.01F * static_cast<float>(index);
  };
  std::uint32_t seen = 0;
  for (const LabelledSample& sample : rig.run(20.0)) seen |= sample.reason_bits;
  EXPECT_EQ(seen, computed_bits & ~bit(Reason::no_bias));  // that is of a rig without a servo
}

TEST(Reasons, SyncLostWhereTheFramesClockIsUnsure) {
  ScriptedRig rig;
  rig.spoil = [](TimedFrame& frame, int index) {
    frame.late = index == 7;
    frame.stamp.uncertainty_s = index == 9 ? 0.0021F : 0.0019F;
  };
  EXPECT_EQ(frames_with(Reason::sync_lost, rig.run(3.0)), (std::vector<int>{7, 9}));
}

TEST(Reasons, GyroUnsteadyBeyondTheSensorsNoiseAndTheTolerance) {
  for (const double amplitude_dps : {2.0, 6.0}) {  // a swing of 5 Hz: 1.4 and 4.2 deg/s, the tolerance is 2
    ScriptedRig rig;
    rig.gyro_dps = [&](double t) { return 100.0 + amplitude_dps * std::sin(2.0 * 3.14159265 * 5.0 * t); };
    const LabelledSample sample = rig.run(4.0).at(12);
    EXPECT_EQ(has(sample, Reason::gyro_unsteady), amplitude_dps > 4.0);
    EXPECT_NEAR(sample.gyro_spread_dps, amplitude_dps / std::sqrt(2.0), 0.1 * amplitude_dps);
  }
}

TEST(Reasons, GyroUnsteadyNotForTheRippleOfThePulses) {
  ScriptedRig rig;
  rig.gyro_dps = [](double t) { return 100.0 + 38.0 * std::sin(2.0 * 3.14159265 * 50.0 * t + 0.3); };
  const LabelledSample sample = rig.run(4.0).at(12);
  EXPECT_FALSE(has(sample, Reason::gyro_unsteady));
  EXPECT_LT(sample.gyro_spread_dps, 0.5F);
}

TEST(Reasons, GyroDisagreesBeyondThreeDeviationsOfBiasScaleAndModel) {
  for (const double gyro_dps : {101.0, 104.0}) {
    ScriptedRig rig;
    rig.gyro_dps = [gyro_dps](double) { return gyro_dps + 5.0; };
    rig.config.response = ServoResponse{.fitted = true, .gyro_ratio = {1.0, 0.005}, .residual_dps = 0.3};
    rig.config.gyro.emplace(GyroErrors{.bias_dps = Estimate{5.0, 0.4}, .noise_dps = 0.1});  // sigma about 0.7
    EXPECT_EQ(has(rig.run(4.0).at(12), Reason::gyro_disagrees), gyro_dps > 103.0);
  }
}

TEST(Reasons, AGyroThatSentNothingWithinAFrameDoesNotDisagree) {
  ScriptedRig rig;
  rig.gyro_dps = [](double t) { return t < 2.0 ? 100.0 : 0.0; };
  rig.config.gyro.emplace(GyroErrors{.bias_dps = Estimate{0.0, 0.1}, .noise_dps = 0.1});
  Labeller labeller(rig.config);
  for (int i = 0; i < 300; ++i) labeller.add(rig.servo_at(rig.offset_s + 0.01 * i));
  for (int i = 0; i < 6; ++i) labeller.add(rig.gyro_at(0.5 * i));
  labeller.add(rig.frame_at(2.3, 0));
  const LabelledSample sample = labeller.finish().at(0);
  EXPECT_TRUE(has(sample, Reason::gyro_gap));
  EXPECT_FALSE(has(sample, Reason::gyro_disagrees));
}

TEST(Reasons, ASaturatedGyroIsNotAskedWhetherItAgrees) {
  const ScriptedRig rig;
  LabelConfig config = rig.config;
  config.gyro.emplace(GyroErrors{.bias_dps = Estimate{0.0, 0.1}});
  Labeller labeller(config);
  for (int i = 0; i < 300; ++i) labeller.add(rig.servo_at(rig.offset_s + 0.01 * i));
  for (int i = 0; i < 600; ++i) {
    TimedGyro gyro = rig.gyro_at(0.005 * i);
    gyro.rate_dps = i % 2 == 0 ? 250.0F : -100.0F;
    gyro.reading.saturated = i % 2 == 0;
    labeller.add(gyro);
  }
  labeller.add(rig.frame_at(2.0, 0));
  const LabelledSample sample = labeller.finish().at(0);
  EXPECT_FALSE(has(sample, Reason::gyro_disagrees));
  EXPECT_FALSE(has(sample, Reason::gyro_unsteady));
}

TEST(Reasons, TelemetryDisagreesWhereADeadlineWasMissed) {
  ScriptedRig rig;
  rig.telemetry_comes = [](double t) { return t < 1.5 || t > 1.51; };  // one message
  EXPECT_EQ(without_start(frames_with(Reason::telemetry_disagrees, rig.run(4.0))),
            frames_meeting(1.4913, 1.5113, 0.2, 32));
}

TEST(Reasons, TelemetryDisagreesWhereThePulseDoesNotFollowTheCommand) {
  const ScriptedRig rig;
  Labeller labeller(rig.config);
  for (int i = 0; i < 300; ++i) {
    TimedServo servo = rig.servo_at(rig.offset_s + 0.01 * i);
    if (i >= 150) servo.state.pulse_us += 4.0F;  // 4.3 deg on a winch, 43 ms of motion
    labeller.add(servo);
  }
  labeller.add(rig.frame_at(1.4, 0));
  labeller.add(rig.frame_at(2.0, 1));
  const auto samples = labeller.finish();
  EXPECT_FALSE(has(samples[0], Reason::telemetry_disagrees));
  EXPECT_TRUE(has(samples[1], Reason::telemetry_disagrees));
}

TEST(Reasons, WarmUpIsAWarningUnlessItIsToldNotToBe) {
  for (const bool invalidates : {false, true}) {
    ScriptedRig rig;
    rig.config.warm_up_invalidates = invalidates;
    rig.spoil = [](TimedFrame& frame, int index) {
      frame.frame.sensor_temp_c = 30.0F + static_cast<float>(index) * 0.125F * 0.02F;  // 1.2 K/min
    };
    const auto samples = rig.run(8.0);
    EXPECT_FALSE(has(samples[20], Reason::warm_up));  // too early to tell
    EXPECT_TRUE(has(samples[60], Reason::warm_up));
    EXPECT_EQ(samples[60].valid, !invalidates);
  }
}

TEST(Reasons, WarmUpIsToldFromFramesThatComeTogetherAsFromOthers) {
  for (const int frames_a_second : {4, 8, 64}) {
    WarmUp warming(0.5), settled(0.5);
    bool warms = false, settles = true;
    for (int i = 0; i < 8 * frames_a_second; ++i) {
      const double time_s = static_cast<double>(i) / frames_a_second;
      warms = warming.push(HostTime(from_s(time_s)), static_cast<float>(30.0 + 0.55 / 60.0 * time_s));
      settles = !settled.push(HostTime(from_s(time_s)), static_cast<float>(30.0 + 0.45 / 60.0 * time_s));
    }
    EXPECT_TRUE(warms) << frames_a_second;
    EXPECT_TRUE(settles) << frames_a_second;
  }
}

TEST(Reasons, WarmUpIsToldToAPercentWhereTheFrameRateChanges) {
  WarmUp warming(0.5), settled(0.5);
  bool warms = false, settles = true;
  double time_s = 0.0;
  for (int i = 0; i < 160; ++i) {
    warms = warming.push(HostTime(from_s(time_s)), static_cast<float>(30.0 + 0.505 / 60.0 * time_s));
    settles = !settled.push(HostTime(from_s(time_s)), static_cast<float>(30.0 + 0.495 / 60.0 * time_s));
    time_s += time_s < 4.0 ? 1.0 / 8.0 : 1.0 / 32.0;
  }
  EXPECT_TRUE(warms);
  EXPECT_TRUE(settles);
}

// A look at all others of the last 30 s for each of them would take an hour.
TEST(Reasons, AMillionFramesAtNearlyOneTimeCostNoMoreEachThanOthers) {
  WarmUp warm_up(0.5);
  int changes = 0;
  for (int i = 0; i < 1'000'000; ++i)
    changes += warm_up.push(HostTime(std::chrono::microseconds(8 * i)), 30.0F) ? 1 : 0;
  EXPECT_EQ(changes, 0);
}

}  // namespace
}  // namespace thermorig::labels
