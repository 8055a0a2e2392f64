// SPDX-License-Identifier: MIT
// A simulated rig that was built or described wrongly: its session says so, and no valid frame has a wrong
// label.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "scripted_bytes.h"
#include "virtual_sweep.h"

namespace thermorig::pipeline {
namespace {

using testing::HasSubstr;

/// What a profile gets wrong.
using Misstate = void (*)(RigProfile& profile);

struct Mistake {
  const char* name;
  const char* world;  // what was built wrongly, or
  Misstate misstate;  // told wrongly
  Witness outlier;
  const char* cause;
};

void nothing(RigProfile&) {}

struct Judged {
  Fits fits;
  Result result;
  VirtualSweep sweep;
};

/// 30, 60 and 90 deg/s both ways, through a profile that may be wrong.
Judged judged(const std::string& world, Misstate misstate, std::uint64_t seed = 2,
              const std::vector<double>& speeds_dps = {30, -30, 60, -60, 90, -90}) {
  auto config = simulation::default_rig(seed, "kitchen");
  simulation::put_in_world(simulation::world_named(world, seed), config);
  std::vector<SweepLeg> legs;
  for (std::size_t i = 0; i < speeds_dps.size(); ++i)
    legs.push_back({4.0 + 4.0 * static_cast<double>(i), 3.5, speeds_dps[i]});
  VirtualSweep sweep = drive(config, legs, 5.0 + 4.0 * static_cast<double>(speeds_dps.size()));
  RigProfile profile = sweep.config.profile;
  misstate(profile);
  Fits fits = first_pass(profile, sweep.chunks, sweep.sent);
  Result result = run(profile, sweep.chunks, fits, sweep.sent);
  return {std::move(fits), std::move(result), std::move(sweep)};
}

int valid_frames(const Judged& judged) {
  int valid = 0;
  for (const LabelledSample& sample : judged.result.samples) valid += sample.valid ? 1 : 0;
  return valid;
}

class OfARig : public testing::TestWithParam<Mistake> {};

TEST_P(OfARig, AMistakeIsNamedAndNoLabelIsSilentlyWrong) {
  const Judged made = judged(GetParam().world, GetParam().misstate);
  const Witnesses& witnesses = made.fits.sync->witnesses;
  EXPECT_EQ(name_of(witnesses.outlier), name_of(GetParam().outlier));
  EXPECT_THAT(witnesses.cause, HasSubstr(GetParam().cause));
  if (GetParam().outlier == Witness::images)
    EXPECT_GT(valid_frames(made), 60);
  else
    EXPECT_EQ(valid_frames(made), 0);
  for (const LabelledSample& sample : made.result.samples) {
    if (!sample.valid && sample.leg == 0) continue;
    if ((sample.reason_bits & ~(bit(Reason::gyro_disagrees) | warning_bits)) != 0) continue;
    const double truth_dps = made.sweep.frames[sample.frame_index].mean_rate_dps;
    EXPECT_NEAR(sample.rate_shaft_dps, truth_dps, 4.0 * double{sample.rate_shaft_uncertainty_dps})
        << sample.frame_index;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Witnesses, OfARig,
    testing::Values(
        Mistake{"rad", "honest,gyro.unit=0.01745", nothing, Witness::gyro, "rad/s"},
        Mistake{"half", "honest,gyro.unit=0.5", nothing, Witness::gyro, "twice"},
        Mistake{"reversed", "honest,gyro.mounted_deg=180", nothing, Witness::gyro, "other way round"},
        Mistake{"other_axis", "honest,gyro.mounted_deg=90", nothing, Witness::gyro, "x axis"},
        Mistake{"turned_over", "honest,camera.turned_over=1", nothing, Witness::images, "mirrored"},
        Mistake{"mirrored", "honest", [](RigProfile& profile) { profile.camera.mirrored = false; },
                Witness::images, "mirrored"},
        Mistake{"lens", "honest", [](RigProfile& profile) { profile.camera.field_of_view_deg = 110.0; },
                Witness::images, "55 deg"},
        Mistake{"scale", "honest", [](RigProfile& profile) { profile.gyro.scale = 2.0; }, Witness::gyro,
                "profile's scale"},
        Mistake{"sign", "honest", [](RigProfile& profile) { profile.gyro.sign = -profile.gyro.sign; },
                Witness::gyro, "other way round"},
        Mistake{"axis", "honest", [](RigProfile& profile) { profile.gyro.axis = 0; }, Witness::gyro,
                "z axis"}),
    [](const auto& of) { return std::string(of.param.name); });

TEST(Witnesses, OfAServoThatTurnsSlowerThanCommandedNoFrameIsValid) {
  const Judged made = judged("honest,servo.top_speed_dps=160", nothing, 2, {190, -190, 200, -200, 195, -195});
  EXPECT_THAT(name_of(made.fits.sync->witnesses.outlier), testing::AnyOf("command", "undecided"));
  EXPECT_EQ(valid_frames(made), 0);
}

/// Faint, far, near, with people and lenses as they come.
TEST(Witnesses, OfRigsInAnyWorldHaveNoOutlier) {
  for (const char* world : {"typical", "hard"})
    for (const std::uint64_t seed : {11, 12})
      EXPECT_EQ(judged(world, nothing, seed).fits.sync->witnesses.cause, "") << world << ' ' << seed;
}

}  // namespace
}  // namespace thermorig::pipeline
