// SPDX-License-Identifier: MIT
#include "thermorig/estimators/odometer/lens_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "room.h"

namespace thermorig::odometer {
namespace {

using ::testing::HasSubstr;

/// There and back at 50 deg/s, 440 degrees apart, with round ends.
double swept_deg(double time_s) {
  const double leg_s = 8.8, turns = time_s / leg_s;
  const double part = turns - 2.0 * std::floor(0.5 * turns);
  return 440.0 * (part < 1.0 ? part : 2.0 - part);
}

Room swept_room() {
  Room room;
  room.duration_s = 54.0;
  room.angle_deg = swept_deg;
  return room;
}

struct Swept {
  std::vector<TimedFrame> frames;
  std::vector<TimedGyro> gyro;
};

Swept swept_in(const Room& room) {
  Swept swept;
  for (const Seen& seen : seen_in(room)) {
    swept.frames.push_back(seen.frame);
    swept.gyro.insert(swept.gyro.end(), seen.gyro.begin(), seen.gyro.end());
  }
  return swept;
}

LensAnswer lens_of(const Swept& swept) {
  GyroProfile profile;
  profile.bias_dps = Room().bias_dps + 0.2;
  profile.bias_uncertainty_dps = 0.5;
  return fit_lens(swept.frames, swept.gyro, profile, CameraProfile());
}

// What it finds, and that a bare wall tells nothing: tests/calibration/lens_test.cpp, on whole simulated
// rigs.

TEST(LensFit, SaysWhyARigThatHardlyTurnsTellsNothing) {
  Room narrow = swept_room();
  narrow.duration_s = 27.0;
  narrow.angle_deg = [](double time_s) { return 0.15 * swept_deg(time_s); };
  EXPECT_THAT(lens_of(swept_in(narrow)).why_not, HasSubstr("turned through"));
  EXPECT_THAT(lens_of({}).why_not, HasSubstr("half-frames"));
}

TEST(LensFit, EndsWithHalvesThatAreNoPicture) {
  Swept swept = swept_in(swept_room());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (std::size_t i = 0; i < swept.frames.size(); ++i)
    if (i % 3 != 0) swept.frames[i].frame.temp_c.fill(i % 2 == 0 ? nan : 1e30F);
  for (std::size_t i = 0; i < swept.gyro.size(); i += 50) swept.gyro[i].rate_dps = nan;
  const LensAnswer answer = lens_of(swept);
  EXPECT_TRUE(answer.fit ? std::isfinite(answer.fit->pitch_scale.value) : !answer.why_not.empty());
}

}  // namespace
}  // namespace thermorig::odometer
