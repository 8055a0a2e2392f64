// SPDX-License-Identifier: MIT
#include <cmath>

#include "calibrated_rig.h"
#include "thermorig/rig/calibration/calibration.h"
#include "thermorig/rig/recording/finalise.h"

namespace thermorig::calibration {
namespace {

Recorded sweeps(const simulation::VirtualRigConfig& config) {
  return record(config, plan_for(CalibrationKind::latency, config));
}

/// From the exposure's end to the first byte, beyond what the gyro takes and its profile does not say.
double true_latency_s(const Recorded& recorded) {
  return recorded.camera_latency_s - recorded.gyro_latency_s +
         recorded.session.raw.header.profile.gyro.link.latency_s;
}

TEST(CalibrateLatency, FindsWhatTheCameraTakesOnEveryServo) {
  for (const char* servo : {"winch", "180", "270"}) {
    const Recorded recorded = sweeps(rig_with(1, servo));
    const LatencyResult result = measure_latency(recorded.session);
    const double off_s = result.camera_latency_s.value - true_latency_s(recorded);
    EXPECT_LT(std::abs(off_s), 0.0015) << servo;  // what the links add is known to that only
    EXPECT_LT(std::abs(off_s), 3.5 * result.camera_latency_s.uncertainty) << servo;
    EXPECT_LT(result.camera_latency_s.uncertainty, 0.001) << servo;
    EXPECT_GT(result.halves, 100U) << servo;
  }
}

TEST(CalibrateLatency, FollowsACameraThatIsLater) {
  auto config = rig_with(2);
  config.camera_latency_s = 0.030;
  const LatencyResult sooner = measure_latency(sweeps(config).session);
  config.camera_latency_s = 0.037;
  const LatencyResult later = measure_latency(sweeps(config).session);
  EXPECT_NEAR(later.camera_latency_s.value - sooner.camera_latency_s.value, 0.007,
              3.0 * std::hypot(sooner.camera_latency_s.uncertainty, later.camera_latency_s.uncertainty));
}

TEST(CalibrateLatency, LeavesNothingToMeasureOnceItIsInTheProfile) {
  auto config = rig_with(4);
  const LatencyResult first = measure_latency(sweeps(config).session);
  apply(first, "2026-07-25T14:35:12Z", config.profile);
  const Recorded again = sweeps(config);
  EXPECT_NEAR(again.session.sync.clock[Device::camera].latency_s, first.camera_latency_s.value,
              3.0 * first.camera_latency_s.uncertainty);
  const LatencyResult second = measure_latency(again.session);
  EXPECT_LT(std::abs(second.offset_s.value),
            3.0 * std::hypot(first.camera_latency_s.uncertainty, second.camera_latency_s.uncertainty));
}

TEST(CalibrateLatency, CountsTheShiftThatASessionMadeByItself) {
  const Recorded recorded = sweeps(rig_with(3));
  const LatencyResult shifted = measure_latency(recorded.session);
  RawRecording raw = recorded.session.raw;
  raw.header.profile.camera.link.latency_s += 0.004;
  raw.header.profile.camera.link.latency_uncertainty_s = 1e-5;  // taken as known: nothing is shifted
  const LatencyResult unshifted = measure_latency(rig::build_session(std::move(raw)));
  EXPECT_NEAR(unshifted.before_s, shifted.before_s + 0.004, 1e-9);
  EXPECT_NEAR(unshifted.camera_latency_s.value, shifted.camera_latency_s.value, 0.0005);
}

TEST(CalibrateLatency, SaysWhyASessionDoesNotTell) {
  const session::Session empty;
  EXPECT_THAT(refusal([&] { measure_latency(empty); }), HasSubstr("the camera's delay cannot be measured: "));
  const auto config = rig_with(1);
  auto rest = plan_for(CalibrationKind::bias, config);
  rest.opening_rest_s = 10.0;
  EXPECT_THAT(refusal([&] { measure_latency(record(config, rest).session); }),
              HasSubstr("the camera's delay cannot be measured: "));
}

}  // namespace
}  // namespace thermorig::calibration
