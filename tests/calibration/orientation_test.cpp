// SPDX-License-Identifier: MIT
#include "calibrated_rig.h"
#include "thermorig/rig/calibration/calibration.h"
#include "thermorig/rig/recording/finalise.h"

namespace thermorig::calibration {
namespace {

/// A rig that is put together as `truth` says, recorded by somebody who believes the profile's defaults.
session::Session recorded_in_error(std::uint64_t seed, const std::string& servo,
                                   const OrientationResult& truth) {
  auto config = rig_with(seed, servo);
  const RigProfile believed = config.profile;
  apply(truth, "2026-07-25T14:35:12Z", config.profile);
  RawRecording raw = record(config, plan_for(CalibrationKind::orientation, config)).session.raw;
  raw.header.profile = believed;
  return rig::build_session(std::move(raw));
}

TEST(CalibrateOrientation, FindsAxisSignAndMirrorWhateverTheProfileBelieves) {
  std::uint64_t seed = 1;
  for (const char* servo : {"winch", "180", "continuous"}) {
    for (const bool mirrored : {true, false}) {
      const OrientationResult truth{
          .gyro_axis = static_cast<int>(seed % 3), .gyro_sign = seed % 2 == 0 ? 1 : -1, .mirrored = mirrored};
      const OrientationResult found = measure_orientation(recorded_in_error(seed, servo, truth));
      EXPECT_EQ(found.gyro_axis, truth.gyro_axis) << servo << seed;
      EXPECT_EQ(found.gyro_sign, truth.gyro_sign) << servo << seed;
      EXPECT_EQ(found.mirrored, mirrored) << servo << seed;
      EXPECT_GT(found.correlation, 0.9) << servo << seed;
      EXPECT_GT(found.contrast, 0.0) << servo << seed;
      ++seed;
    }
  }
}

/// An axis across follows the turning as faithfully as the one along it, but shows next to nothing of it.
TEST(CalibrateOrientation, KnowsTheAxisOfAGyroWhoseOtherAxesSeeSomeOfTheTurning) {
  auto config = rig_with(1);
  config.world.gyro.cross_axis = 0.02;
  const OrientationResult found =
      measure_orientation(record(config, plan_for(CalibrationKind::orientation, config)).session);
  EXPECT_EQ(found.gyro_axis, config.profile.gyro.axis);
  EXPECT_EQ(found.gyro_sign, config.profile.gyro.sign);
}

TEST(CalibrateOrientation, SaysWhyASessionDoesNotTell) {
  const session::Session empty;
  EXPECT_THAT(refusal([&] { measure_orientation(empty); }), HasSubstr("hardly moved"));
  const auto config = rig_with(1);
  auto rest = plan_for(CalibrationKind::bias, config);
  rest.opening_rest_s = 10.0;
  EXPECT_THAT(refusal([&] { measure_orientation(record(config, rest).session); }), HasSubstr("hardly moved"));
  session::Session loose = record(config, plan_for(CalibrationKind::orientation, config)).session;
  for (TimedGyro& sample : loose.gyro) sample.reading.rate_dps = {0.1F, 0.1F, 0.1F};
  EXPECT_THAT(refusal([&] { measure_orientation(loose); }),
              HasSubstr("no axis of the gyro turns with the servo"));
  session::Session blind = record(config, plan_for(CalibrationKind::orientation, config)).session;
  for (TimedFrame& frame : blind.frames) frame.frame.temp_c.fill(21.0F);
  EXPECT_THAT(refusal([&] { measure_orientation(blind); }), HasSubstr("direction cannot be measured"));
}

}  // namespace
}  // namespace thermorig::calibration
