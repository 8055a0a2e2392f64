// SPDX-License-Identifier: MIT
#include "pipeline/camera_shift.h"

#include <gtest/gtest.h>

namespace thermorig::pipeline {
namespace {

ClockFit clock_at(double t_s) {
  ClockFit clock;
  clock.times = {{HostTime(from_s(t_s)), 1e-4F, 2e-3F, 1e-4F}};
  clock.report.latency_s = 0.020;
  clock.report.latency_uncertainty_s = 0.010;
  return clock;
}

RigProfile profile_with(double camera_uncertainty_s, double gyro_uncertainty_s) {
  RigProfile profile;
  profile.camera.link.latency_uncertainty_s = camera_uncertainty_s;
  profile.gyro.link.latency_uncertainty_s = gyro_uncertainty_s;
  return profile;
}

TEST(CameraShift, AnAssumedLatencyGivesWayToWhatTheImagesSay) {
  ClockFit clock = clock_at(5.0);
  CameraOffset offset{.offset_s = Estimate{0.008, 0.0001}, .why_not = "", .halves = 400};
  apply_camera_offset(profile_with(0.010, 0.0), offset, clock);
  EXPECT_TRUE(offset.applied);
  EXPECT_NEAR(to_s(clock.times[0].time.time_since_epoch()), 4.992, 2e-6);
  EXPECT_NEAR(clock.report.latency_s, 0.028, 2e-6);
  EXPECT_NEAR(clock.report.latency_uncertainty_s, 0.0001, 1e-6);
}

TEST(CameraShift, WeighsByInverseVarianceAndCountsTheGyrosOwnLatency) {
  ClockFit clock = clock_at(5.0);
  CameraOffset offset{.offset_s = Estimate{0.008, 0.003}, .why_not = "", .halves = 400};
  apply_camera_offset(profile_with(0.010, 0.004), offset, clock);  // images: hypot(3, 4) = 5 ms
  EXPECT_NEAR(clock.report.latency_s, 0.020 + 0.008 * 100.0 / 125.0, 1e-9);
  EXPECT_NEAR(clock.report.latency_uncertainty_s, 0.001 / std::sqrt(0.01 * 0.01 + 0.005 * 0.005) * 0.05,
              1e-9);
  EXPECT_EQ(offset.offset_s->value, 0.008);  // what was seen stays as it is
}

TEST(CameraShift, ACalibratedLatencyStays) {
  ClockFit clock = clock_at(5.0);
  CameraOffset offset{.offset_s = Estimate{0.008, 0.0005}, .why_not = "", .halves = 400};
  apply_camera_offset(profile_with(0.0003, 0.0), offset, clock);
  EXPECT_FALSE(offset.applied);
  EXPECT_EQ(clock.times[0].time, HostTime(from_s(5.0)));
  EXPECT_EQ(clock.report.latency_s, 0.020);
}

TEST(CameraShift, NothingIsShiftedByWhatIsNotKnown) {
  ClockFit clock = clock_at(5.0);
  CameraOffset none{.offset_s = std::nullopt, .why_not = "nothing moved"};
  apply_camera_offset(profile_with(0.010, 0.0), none, clock);
  CameraOffset wild{.offset_s = Estimate{std::nan(""), std::nan("")}, .why_not = ""};
  apply_camera_offset(profile_with(0.010, 0.0), wild, clock);
  EXPECT_FALSE(none.applied);
  EXPECT_FALSE(wild.applied);
  EXPECT_EQ(clock.times[0].time, HostTime(from_s(5.0)));
  ClockFit empty;
  CameraOffset offset{.offset_s = Estimate{0.008, 0.0005}, .why_not = ""};
  apply_camera_offset(profile_with(0.010, 0.0), offset, empty);
  EXPECT_FALSE(offset.applied);
}

}  // namespace
}  // namespace thermorig::pipeline
