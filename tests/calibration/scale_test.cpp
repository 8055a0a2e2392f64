// SPDX-License-Identifier: MIT
#include <cmath>

#include "calibrated_rig.h"
#include "thermorig/rig/calibration/calibration.h"

namespace thermorig::calibration {
namespace {

/// A rest of a minute in which somebody turns the rig.
Recorded turned_by_hand(simulation::VirtualRigConfig config, double angle_deg, double duration_s = 20.0) {
  config.hand_turns.push_back(
      {.begin = config.start + from_s(15.0), .duration_s = duration_s, .angle_deg = angle_deg});
  return record(config, plan_for(CalibrationKind::bias, config));
}

TEST(CalibrateScaleByMarks, FindsTheGyrosScaleWhicheverWayTheRigIsTurned) {
  for (double angle_deg : {360.0, -720.0}) {
    const Recorded recorded = turned_by_hand(rig_with(1, "180"), angle_deg);
    const ScaleResult result = measure_scale_by_marks(recorded.session, std::abs(angle_deg));
    // The simulated operator meets the marks exactly: what is left is the gyro's own noise and bias.
    EXPECT_NEAR(result.gyro_scale.value, recorded.gyro.scale, 0.0008) << angle_deg;
    EXPECT_NEAR(result.gyro_scale.uncertainty, 0.71 / std::abs(angle_deg), 0.0003);
    EXPECT_FALSE(result.servo_scale);
  }
}

TEST(CalibrateScaleByMarks, SaysWhyATurnDoesNotTell) {
  const Recorded half = turned_by_hand(rig_with(1), 180.0);
  EXPECT_THAT(refusal([&] { measure_scale_by_marks(half.session, 360.0); }), HasSubstr("not of 360.0"));
  const Recorded still = turned_by_hand(rig_with(1), 0.0);
  EXPECT_THAT(refusal([&] { measure_scale_by_marks(still.session, 360.0); }), HasSubstr("was not turned"));
  const session::Session empty;
  EXPECT_THAT(refusal([&] { measure_scale_by_marks(empty, 360.0); }),
              HasSubstr("do not show the gyro's bias"));
  session::Session holed = turned_by_hand(rig_with(1), 360.0).session;
  const auto middle = holed.gyro.begin() + static_cast<std::ptrdiff_t>(holed.gyro.size() * 2 / 5);
  holed.gyro.erase(middle, middle + 40);
  EXPECT_THAT(refusal([&] { measure_scale_by_marks(holed, 360.0); }), HasSubstr("missing for 205 ms"));
  session::Session fast = turned_by_hand(rig_with(1), 360.0).session;
  fast.gyro[fast.gyro.size() * 2 / 5].reading.saturated = true;
  EXPECT_THAT(refusal([&] { measure_scale_by_marks(fast, 360.0); }), HasSubstr("faster than it can measure"));
}

TEST(CalibrateScale, FindsGyroAndServoFromATurnThatCloses) {
  double gyro_squares = 0, servo_squares = 0;
  int count = 0;
  for (const char* servo : {"winch", "continuous"}) {
    for (std::uint64_t seed : {1, 2}) {
      const auto config = rig_with(seed, servo);
      const Recorded recorded = record(config, plan_for(CalibrationKind::scale, config));
      const ScaleResult result = measure_scale(recorded.session);
      const double gyro_off = result.gyro_scale.value - recorded.gyro.scale;
      ASSERT_TRUE(result.servo_scale) << servo << seed;
      const double servo_off = result.servo_scale->value - recorded.servo_scale;
      EXPECT_LT(std::abs(gyro_off), 3.5 * result.gyro_scale.uncertainty) << servo << seed;
      EXPECT_LT(result.gyro_scale.uncertainty, 0.005) << servo << seed;
      EXPECT_LT(std::abs(servo_off), 3.5 * result.servo_scale->uncertainty) << servo << seed;
      EXPECT_GT(result.servo_scale->uncertainty, 0.002) << servo << seed;  // not driven everywhere
      EXPECT_GT(result.turned_deg, 360.0) << servo << seed;
      gyro_squares += gyro_off * gyro_off;
      servo_squares += servo_off * servo_off;
      ++count;
    }
  }
  EXPECT_LT(std::sqrt(gyro_squares / count), 0.0015);
  EXPECT_LT(std::sqrt(servo_squares / count), 0.0015);
}

TEST(CalibrateScale, FindsTheGyroWhereTheRigIsTurnedByHand) {
  for (std::uint64_t seed : {1, 2}) {
    const Recorded recorded = turned_by_hand(rig_with(seed, "270"), 400.0);
    const ScaleResult result = measure_scale(recorded.session);
    EXPECT_LT(std::abs(result.gyro_scale.value - recorded.gyro.scale), 3.5 * result.gyro_scale.uncertainty);
    EXPECT_LT(result.gyro_scale.uncertainty, 0.005);
    EXPECT_FALSE(result.servo_scale);
  }
}

TEST(CalibrateScale, MakesLabelsOfLaterSessionsBetter) {
  for (const char* servo : {"winch", "270"}) {
    auto config = rig_with(1, servo);
    rig::PlanOverrides overrides;
    overrides.magnitudes_dps = {60.0, 150.0};
    const rig::SweepPlan plan = rig::load_plan("quick", "kitchen", 1, overrides);
    const Recorded before = record(config, plan);
    const Recorded turn = servo == std::string("winch")
                              ? record(config, plan_for(CalibrationKind::scale, config))
                              : turned_by_hand(config, 400.0);
    apply(measure_scale(turn.session), "2026-07-25T14:35:12Z", config.profile);
    const Recorded after = record(config, plan);
    ASSERT_GT(after.label.frames, 20) << servo;
    EXPECT_LT(after.label.error_dps, 1.0) << servo;
    // A winch turns round in that plan: its own images tell the scale nearly as well.
    const double share = before.session.sync.gyro.scale.uncertainty < 0.002 ? 0.8 : 0.5;
    EXPECT_EQ(share, servo == std::string("winch") ? 0.8 : 0.5);
    EXPECT_LT(after.label.uncertainty_dps, share * before.label.uncertainty_dps) << servo;
    EXPECT_LT(before.label.worst, 4.5) << servo;
    EXPECT_LT(after.label.worst, 4.5) << servo;
    EXPECT_TRUE(after.session.sync.servo.scale_calibrated);
  }
}

TEST(CalibrateScale, SaysWhyNoTurnCloses) {
  const Recorded half = turned_by_hand(rig_with(1), 180.0);
  EXPECT_THAT(refusal([&] { measure_scale(half.session); }), HasSubstr("no turn closes"));
  const session::Session empty;
  EXPECT_THAT(refusal([&] { measure_scale(empty); }), HasSubstr("there is no gyro"));
}

}  // namespace
}  // namespace thermorig::calibration
