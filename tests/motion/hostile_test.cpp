// SPDX-License-Identifier: MIT
// Whatever comes from a device or a file, nothing may crash, hang or be made up.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "thermorig/fit/motion/panorama_fit.h"
#include "turning_rig.h"

namespace thermorig::motion {
namespace {

constexpr float nan_f = std::numeric_limits<float>::quiet_NaN();
constexpr double nan_d = std::numeric_limits<double>::quiet_NaN();

const Turning& sweeps() {
  static const Turning turning =
      turn(simulation::default_rig(7, "garden"), back_and_forth(100.0, 2.0, 32.0), 32.0);
  return turning;
}

/// All four questions; whatever is answered must be a number.
void ask(const Turning& turning, const View& view = {}) {
  const CameraOffset offset = camera_offset(turning.frames, turning.gyro, view, turning.errors);
  EXPECT_NE(offset.offset_s.has_value(), !offset.why_not.empty());
  if (offset.offset_s) {
    EXPECT_TRUE(std::isfinite(offset.offset_s->value) && offset.offset_s->uncertainty > 0.0);
  }
  const TurnResult scale = gyro_scale(turning.frames, turning.gyro, view, turning.errors);
  EXPECT_NE(scale.gyro_scale.has_value(), !scale.why_not.empty());
  const Orientation side = orientation(turning.frames, turning.gyro, view, turning.errors);
  EXPECT_NE(side.mirrored.has_value(), !side.why_not.empty());
  newer_half(turning.frames, turning.gyro, view, turning.errors);
}

TEST(Hostile, NothingAtAllIsAnsweredByNothing) {
  Turning turning;
  ask(turning);
  EXPECT_EQ(camera_offset({}, {}, {}, {}).why_not, "there is no gyro");
  turning.gyro = sweeps().gyro;
  ask(turning);
  turning.gyro.resize(2);
  turning.frames.assign(sweeps().frames.begin(), sweeps().frames.begin() + 2);
  ask(turning);
}

TEST(Hostile, NumbersThatAreNoneAreLeftOut) {
  Turning turning = sweeps();
  for (std::size_t i = 0; i < turning.gyro.size(); i += 50) turning.gyro[i].rate_dps = nan_f;
  for (std::size_t i = 0; i < turning.frames.size(); ++i)
    turning.frames[i].frame.temp_c[i % frame_pixels] = i % 2 == 0 ? nan_f : 1e30F;
  const CameraOffset found = camera_offset(turning.frames, turning.gyro, {}, turning.errors);
  ASSERT_TRUE(found.offset_s) << found.why_not;
  EXPECT_NEAR(found.offset_s->value, 0.0, 0.002);
  for (TimedFrame& frame : turning.frames) frame.frame.temp_c.fill(nan_f);
  ask(turning);
  for (TimedGyro& sample : turning.gyro) sample.rate_dps = nan_f;
  ask(turning);
}

TEST(Hostile, SettingsThatMakeNoSenseAreRefusedWithAReason) {
  for (const double width_deg : {0.0, -55.0, nan_d, 1e300}) {
    ask(sweeps(), {width_deg, true});
    const CameraOffset found =
        camera_offset(sweeps().frames, sweeps().gyro, {width_deg, true}, sweeps().errors);
    EXPECT_NE(found.why_not.find("field of view"), std::string::npos);
  }
  for (const double value : {0.0, -1.0, nan_d, 1e300}) {
    Turning turning = sweeps();
    turning.errors.scale = {value, nan_d};
    ask(turning);
    turning = sweeps();
    turning.errors.bias_dps = Estimate{value, value};
    ask(turning);
  }
}

TEST(Hostile, TimesMayRepeatRunBackwardsOrLieYearsApart) {
  Turning turning = sweeps();
  for (std::size_t i = 0; i + 1 < turning.gyro.size(); i += 7)
    std::swap(turning.gyro[i].stamp, turning.gyro[i + 1].stamp);
  for (TimedFrame& frame : turning.frames) std::swap(frame.half[0].begin, frame.half[0].end);
  ask(turning);
  turning = sweeps();
  for (std::size_t i = 0; i < turning.gyro.size(); ++i)
    turning.gyro[i].stamp.time = HostTime(from_s(1e5 * static_cast<double>(i)));
  for (std::size_t i = 0; i < turning.frames.size(); ++i)
    for (HalfExposure& half : turning.frames[i].half)
      half = {HostTime(from_s(3e5 * static_cast<double>(i) + 1e6)),
              HostTime(from_s(3e5 * static_cast<double>(i) + 1e6 + 0.125))};
  ask(turning);
}

TEST(Hostile, AGyroThatSpinsMadlyOrStandsStillIsBorne) {
  Turning turning = sweeps();
  for (TimedGyro& sample : turning.gyro) sample.rate_dps = 9e4F;
  ask(turning);
  for (TimedGyro& sample : turning.gyro) sample.rate_dps = 0.0F;
  ask(turning);
}

TEST(Hostile, FramesThatNeverChangeTellNothing) {
  Turning turning = sweeps();
  for (TimedFrame& frame : turning.frames) frame.frame.temp_c.fill(20.0F);
  ask(turning);
  EXPECT_FALSE(camera_offset(turning.frames, turning.gyro, {}, turning.errors).offset_s);
  EXPECT_FALSE(orientation(turning.frames, turning.gyro, {}, turning.errors).mirrored);
}

}  // namespace
}  // namespace thermorig::motion
