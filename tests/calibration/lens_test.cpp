// SPDX-License-Identifier: MIT
#include <cmath>

#include "calibrated_rig.h"
#include "thermorig/rig/calibration/calibration.h"

namespace thermorig::calibration {
namespace {

/// By half of the plan: these rigs have much to see, and tests are to be quick.
Recorded swept(const simulation::VirtualRigConfig& config) {
  rig::SweepPlan plan = plan_for(CalibrationKind::lens, config);
  plan.leg_rates_dps.resize(plan.leg_rates_dps.size() / 2);
  return record(config, plan);
}

void expect_near(const Estimate& found, double truth, const char* what) {
  EXPECT_LT(std::abs(found.value - truth), 3.0 * found.uncertainty) << what;
}

TEST(CalibrateLens, FindsPitchDistortionTiltAndRoll) {
  auto config = rig_with(2);
  config.world.camera.pitch_error = -0.02;
  config.world.camera.distortion = 0.04;
  config.world.camera.tilt_deg = 3.0;
  config.world.camera.roll_deg = -2.0;
  const LensResult result = measure_lens(swept(config).session);
  EXPECT_NEAR(result.pitch_scale.value, 0.98, 0.005);
  EXPECT_LT(result.pitch_scale.uncertainty, 0.005);
  expect_near(result.pitch_scale, 0.98, "pitch");
  ASSERT_TRUE(result.distortion && result.tilt_deg && result.roll_deg);
  expect_near(*result.distortion, 0.04, "distortion");
  expect_near(*result.tilt_deg, 3.0, "tilt");
  expect_near(*result.roll_deg, -2.0, "roll");
  EXPECT_TRUE(result.is_closed);
}

TEST(CalibrateLens, FindsAWideLensWithRowsOneAfterTheOther) {
  auto config = rig_with(3);
  config.profile.camera.field_of_view_deg = 110.0;
  config.world.camera.pitch_error = 0.015;
  config.world.camera.rolling_rows = 1.0;
  const LensResult result = measure_lens(swept(config).session);
  EXPECT_NEAR(result.pitch_scale.value, 1.015, 0.005);
  ASSERT_TRUE(result.row_spread);
  EXPECT_NEAR(result.row_spread->value, 1.0, 0.06);
  EXPECT_TRUE(is_not_plain(*result.row_spread));
}

TEST(CalibrateLens, RefusesWithoutAWholeTurnUnlessTheGyrosScaleIsKnown) {
  const auto config = rig_with(2, "270");
  session::Session session = swept(config).session;
  EXPECT_THAT(refusal([&] { measure_lens(session); }), HasSubstr("no whole turn closes"));
  session.sync.gyro.scale = {1.0, 0.015};
  const LensResult result = measure_lens(session);
  EXPECT_FALSE(result.is_closed);
  EXPECT_GE(result.pitch_scale.uncertainty, 0.015);
}

TEST(CalibrateLens, RefusesABareWallAndARigThatRests) {
  auto config = rig_with(2);
  config.world.scene.contrast = 0.02;
  const session::Session session = swept(config).session;
  EXPECT_THAT(refusal([&] { measure_lens(session); }), HasSubstr("the lens cannot be measured"));
  const Recorded resting = record(config, plan_for(CalibrationKind::bias, config));
  EXPECT_THAT(refusal([&] { measure_lens(resting.session); }), HasSubstr("half-frames"));
}

TEST(CalibrateLens, KeepsTheGyrosFilterWhichNoImageTells) {
  auto config = rig_with(2);
  config.profile.gyro.bandwidth_hz = 0.0;
  config.gyro_grade = simulation::GyroGrade::mpu6050_raw;
  config.world.gyro.bandwidth_hz = 25.0;
  const LensResult result = measure_lens(swept(config).session);
  ASSERT_TRUE(result.gyro_delay_s);
  EXPECT_NEAR(result.gyro_delay_s->value, 0.009, 0.003);
  RigProfile profile = config.profile;
  apply(result, "2026-01-01T00:00:00Z", profile);
  EXPECT_NEAR(*profile.gyro.stated_delay_s(), result.gyro_delay_s->value, 1e-6);
}

}  // namespace
}  // namespace thermorig::calibration
