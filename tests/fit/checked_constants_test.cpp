// SPDX-License-Identifier: MIT
#include "fit/checked_constants.h"
#include "thermorig/sensors/camera_protocol.h"

#include <gtest/gtest.h>

#include <cmath>

namespace thermorig::fit {

using namespace pipeline;

namespace {

ClockFit clock_at(double t_s) {
  ClockFit clock;
  clock.times = {{HostTime(from_s(t_s)), 1e-4F, 2e-3F, 1e-4F}};
  clock.report.latency_s = 0.020;
  clock.report.latency_uncertainty_s = 0.010;
  return clock;
}

double time_s(const ClockFit& clock) {
  return to_s(clock.times[0].time.time_since_epoch());
}

/// At so many frames a second that how its rows are read hardly matters.
CameraProfile assumed_camera(double uncertainty_s) {
  CameraProfile camera;
  camera.output_rate_hz = 1e6;
  camera.link.latency_uncertainty_s = uncertainty_s;
  return camera;
}

CameraProfile calibrated_camera(double uncertainty_s) {
  CameraProfile camera = assumed_camera(uncertainty_s);
  camera.link.latency_measured_utc = "2026-11-23T12:00:00Z";
  return camera;
}

ClockReport gyro_clock(double latency_uncertainty_s) {
  ClockReport report;
  report.latency_uncertainty_s = latency_uncertainty_s;
  return report;
}

GyroErrors known_filter() {
  GyroErrors errors;
  errors.filter_source = "profile";
  return errors;
}

CameraOffset seen(double offset_s, double uncertainty_s) {
  return {.offset_s = Estimate{offset_s, uncertainty_s}, .why_not = "", .halves = 400};
}

TEST(CheckedLatency, AnAssumedOneGivesWayToWhatTheImagesSay) {
  ClockFit clock = clock_at(5.0);
  CameraOffset offset = seen(0.008, 0.0001);
  apply_camera_offset(assumed_camera(0.010), known_filter(), gyro_clock(0.0), offset, clock);
  EXPECT_TRUE(offset.applied);
  EXPECT_FALSE(offset.contradicts);
  EXPECT_NEAR(time_s(clock), 4.992, 2e-6);
  EXPECT_NEAR(clock.report.latency_s, 0.028, 2e-6);
  EXPECT_NEAR(clock.report.latency_uncertainty_s, 0.0001, 1e-6);
}

TEST(CheckedLatency, AnAssumedOneIsWeighedByInverseVarianceAndAsUnsureAsTheGyros) {
  ClockFit clock = clock_at(5.0);
  CameraOffset offset = seen(0.008, 0.005);
  apply_camera_offset(assumed_camera(0.010), known_filter(), gyro_clock(0.004), offset, clock);
  EXPECT_NEAR(clock.report.latency_s, 0.020 + 0.008 * 100.0 / 125.0, 1e-9);
  EXPECT_NEAR(clock.report.latency_uncertainty_s, std::hypot(std::sqrt(0.8) * 0.005, 0.004), 1e-9);
  EXPECT_EQ(offset.offset_s->value, 0.008);  // what was seen stays as it is
}

TEST(CheckedLatency, AnAssumedOneDoesNotKnowWhenInARefreshTheMiddleRowsAreRead) {
  CameraProfile camera = assumed_camera(0.010);
  camera.output_rate_hz = 8.0;
  const double stated_s = sensors::latency_uncertainty_s(camera);
  EXPECT_GT(3.0 * stated_s, 0.0625 + 0.030);  // half of a refresh, and three deviations of the bridge's own
  camera.link.latency_measured_utc = "2026-11-23T12:00:00Z";
  EXPECT_EQ(sensors::latency_uncertainty_s(camera), 0.010);
}

TEST(CheckedLatency, WithoutImagesThatTellAnAssumedOneStaysAsUnsureAsItIs) {
  ClockFit clock = clock_at(5.0);
  CameraProfile camera = assumed_camera(0.010);
  camera.output_rate_hz = 8.0;
  CameraOffset none{.offset_s = std::nullopt, .why_not = "nothing turned"};
  apply_camera_offset(camera, known_filter(), gyro_clock(0.002), none, clock);
  EXPECT_NEAR(clock.report.latency_uncertainty_s, 0.0374, 1e-4);
}

TEST(CheckedLatency, AnAssumedOneGivesWayToImagesThatKnowMoreThanHowRowsAreRead) {
  ClockFit clock = clock_at(5.0);
  CameraProfile camera = assumed_camera(0.010);
  camera.output_rate_hz = 8.0;
  const double assumed_s = std::hypot(0.010, 0.0625 / std::sqrt(3.0));
  const double weight = assumed_s * assumed_s / (assumed_s * assumed_s + 0.020 * 0.020);
  CameraOffset offset = seen(0.030, 0.020);
  apply_camera_offset(camera, known_filter(), gyro_clock(0.0), offset, clock);
  EXPECT_TRUE(offset.applied);
  EXPECT_NEAR(clock.report.latency_s, 0.020 + 0.030 * weight, 1e-9);
  EXPECT_NEAR(clock.report.latency_uncertainty_s, 0.020 * std::sqrt(weight), 1e-9);
  CameraOffset vague = seen(0.030, 0.040);
  apply_camera_offset(camera, known_filter(), gyro_clock(0.0), vague, clock);
  EXPECT_FALSE(vague.applied);
}

TEST(CheckedLatency, ACalibratedOneStaysWhileTheImagesAgree) {
  ClockFit clock = clock_at(5.0);
  CameraOffset offset = seen(0.0012, 0.0003);
  apply_camera_offset(calibrated_camera(0.0004), known_filter(), gyro_clock(0.002), offset, clock);
  EXPECT_FALSE(offset.applied);
  EXPECT_FALSE(offset.contradicts);
  EXPECT_EQ(clock.times[0].time, HostTime(from_s(5.0)));
  EXPECT_EQ(clock.report.latency_s, 0.020);
  EXPECT_NEAR(clock.report.latency_uncertainty_s, std::hypot(0.0004, 0.002), 1e-9);
}

TEST(CheckedLatency, ACalibratedOneThatTheImagesContradictGivesWay) {
  ClockFit clock = clock_at(5.0);
  CameraOffset offset = seen(0.010, 0.0003);
  apply_camera_offset(calibrated_camera(0.0004), known_filter(), gyro_clock(0.0), offset, clock);
  EXPECT_TRUE(offset.applied);
  EXPECT_TRUE(offset.contradicts);
  EXPECT_NEAR(time_s(clock), 4.990, 1e-9);
  EXPECT_NEAR(clock.report.latency_uncertainty_s, 0.0003, 1e-9);
}

TEST(CheckedLatency, AFilterThatNobodyKnowsMayExplainItSoNoCalibrationIsBlamed) {
  ClockFit clock = clock_at(5.0);
  CameraOffset offset = seen(0.010, 0.0003);
  GyroErrors unknown_filter;
  unknown_filter.filter_delay_s = {0.0, 0.018};
  apply_camera_offset(calibrated_camera(0.0004), unknown_filter, gyro_clock(0.018), offset, clock);
  EXPECT_TRUE(offset.applied);  // labels hang on the gyro
  EXPECT_FALSE(offset.contradicts);
  EXPECT_NEAR(clock.report.latency_uncertainty_s, 0.018, 1e-5);
}

TEST(CheckedLatency, NothingIsShiftedByWhatIsNotKnown) {
  ClockFit clock = clock_at(5.0);
  CameraOffset none{.offset_s = std::nullopt, .why_not = "nothing moved"};
  apply_camera_offset(assumed_camera(0.010), known_filter(), gyro_clock(0.0), none, clock);
  CameraOffset wild = seen(std::nan(""), std::nan(""));
  apply_camera_offset(assumed_camera(0.010), known_filter(), gyro_clock(0.0), wild, clock);
  EXPECT_FALSE(none.applied);
  EXPECT_FALSE(wild.applied);
  EXPECT_EQ(clock.times[0].time, HostTime(from_s(5.0)));
  ClockFit empty;
  CameraOffset offset = seen(0.008, 0.0005);
  apply_camera_offset(assumed_camera(0.010), known_filter(), gyro_clock(0.0), offset, empty);
  EXPECT_FALSE(offset.applied);
}

GyroErrors calibrated_scale(double value, double uncertainty) {
  GyroErrors errors;
  errors.scale = {value, uncertainty};
  errors.scale_calibrated = true;
  return errors;
}

TEST(CheckedScale, TurnsThatAgreeAreWeighedWithTheCalibration) {
  GyroErrors errors = calibrated_scale(1.010, 0.0004);
  apply_turns({.gyro_scale = Estimate{1.0108, 0.0004}, .turned_deg = 800.0, .why_not = ""}, errors);
  EXPECT_FALSE(errors.scale_contradicts);
  EXPECT_NEAR(errors.scale.value, 1.0104, 1e-9);
  EXPECT_NEAR(errors.scale.uncertainty, 0.0004 / std::sqrt(2.0), 1e-9);
  EXPECT_EQ(errors.scale_by_turns->value, 1.0108);
}

TEST(CheckedScale, ACalibrationThatTurnsContradictGivesWay) {
  GyroErrors errors = calibrated_scale(1.0128, 0.0004);
  apply_turns({.gyro_scale = Estimate{1.0231, 0.0001}, .turned_deg = 800.0, .why_not = ""}, errors);
  EXPECT_TRUE(errors.scale_contradicts);
  EXPECT_EQ(errors.scale, (Estimate{1.0231, 0.0001}));
}

TEST(CheckedScale, AnAssumedOneIsNeverContradicted) {
  GyroErrors errors;
  errors.scale = {1.0, 0.03};
  apply_turns({.gyro_scale = Estimate{1.2, 0.0001}, .turned_deg = 800.0, .why_not = ""}, errors);
  EXPECT_FALSE(errors.scale_contradicts);
  EXPECT_NEAR(errors.scale.value, 1.2, 1e-4);
}

TEST(CheckedScale, WithoutTurnsTheProfileStaysAndTheReasonIsKept) {
  GyroErrors errors = calibrated_scale(1.0128, 0.0004);
  apply_turns({.gyro_scale = std::nullopt, .turned_deg = 90.0, .why_not = "no turn closes"}, errors);
  EXPECT_EQ(errors.scale, (Estimate{1.0128, 0.0004}));
  EXPECT_EQ(errors.scale_why_not, "no turn closes");
}

TEST(CheckedFilter, ItsDelayIsLatencyOfTheGyro) {
  ClockFit clock = clock_at(5.0);
  GyroErrors errors;
  errors.filter_delay_s = {0.011, 0.001};
  apply_filter_delay(errors, clock);
  EXPECT_NEAR(time_s(clock), 4.989, 1e-9);
  EXPECT_NEAR(clock.report.latency_s, 0.031, 1e-12);
  EXPECT_NEAR(clock.report.latency_uncertainty_s, std::hypot(0.010, 0.001), 1e-12);
}

}  // namespace
}  // namespace thermorig::fit
