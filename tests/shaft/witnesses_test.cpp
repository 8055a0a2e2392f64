// SPDX-License-Identifier: MIT
// Command, gyro and images: who contradicts the other two, and the likely cause by its factor.
#include "thermorig/fit/shaft/witnesses.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "labels/scripted_rig.h"
#include "thermorig/fit/shaft/gyro_errors.h"
#include "thermorig/fit/shaft/servo_response.h"

namespace thermorig::fit {

using namespace labels;

namespace {

using testing::HasSubstr;

constexpr double one_leg_s = 4.0;

/// A rest of 3 s, then legs of 4 s, in which the gyro shows `gyro_axes` of the commanded speed.
struct Rig {
  std::array<double, 3> gyro_axes{0.0, 0.0, 1.0};
  std::optional<Estimate> images = Estimate{1.0, 0.01};
  RigProfile profile{};
  std::vector<double> rates_dps{40, -40, 90, -90};
  float bias_dps = 1.5F;
  float range_dps = 1e6F;

  double rate_dps(double t) const {
    const auto leg = static_cast<std::size_t>(std::max(0.0, (t - 3.0) / one_leg_s));
    return t < 3.0 || leg >= rates_dps.size() ? 0.0 : rates_dps[leg];
  }
  double end_s() const { return 3.0 + one_leg_s * static_cast<double>(rates_dps.size()); }

  std::vector<TimedServo> servo() const {
    std::vector<TimedServo> messages;
    for (double t = 0.0; t < end_s(); t += 0.01) {
      TimedServo message;
      message.stamp.time = at_s(t);
      message.mcu_time_us = std::llround(1e6 * t);
      message.state.rate_dps = rate_dps(t);
      message.state.motion = rate_dps(t) == 0.0 ? ServoMotion::holding : ServoMotion::steady;
      message.state.leg = rate_dps(t) == 0.0 ? std::uint16_t{0} : std::uint16_t(1.0 + (t - 3.0) / one_leg_s);
      messages.push_back(message);
    }
    return messages;
  }

  std::vector<TimedGyro> gyro() const {
    std::vector<TimedGyro> samples;
    const auto axis = static_cast<std::size_t>(profile.gyro.axis);
    for (int i = 0; i < static_cast<int>(200.0 * end_s()) + 4; ++i) {
      TimedGyro sample;
      sample.stamp.time = at_s(0.005 * i);
      for (std::size_t k = 0; k < 3; ++k)
        sample.reading.rate_dps[k] = std::clamp(
            static_cast<float>(gyro_axes[k] * rate_dps(0.005 * i)) + bias_dps, -range_dps, range_dps);
      sample.reading.saturated = std::abs(sample.reading.rate_dps[axis]) >= range_dps;
      sample.rate_dps = static_cast<float>(profile.gyro.sign) * sample.reading.rate_dps[axis];
      samples.push_back(sample);
    }
    return samples;
  }

  Witnesses compared() const {
    const GyroErrors errors = fit_gyro_errors(gyro(), servo(), profile.gyro);
    return compare_witnesses(servo(), gyro(), errors, profile, {images, images ? "" : "too little to see"});
  }
};

struct Compared {
  const char* name;
  std::array<double, 3> gyro_axes;
  std::optional<Estimate> images;
  Witness outlier;
  const char* cause;
  const char* remedy;
};

const Estimate as_commanded{1.02, 0.01};
constexpr double radian = 180.0 / 3.14159265358979;

class OfMistakes : public testing::TestWithParam<Compared> {};

TEST_P(OfMistakes, TheLikelyCauseIsNamed) {
  Rig rig{.gyro_axes = GetParam().gyro_axes, .images = GetParam().images};
  rig.profile.gyro.protocol = "text";
  const Witnesses witnesses = rig.compared();
  EXPECT_EQ(name_of(witnesses.outlier), name_of(GetParam().outlier));
  EXPECT_THAT(witnesses.cause, HasSubstr(GetParam().cause));
  EXPECT_THAT(witnesses.remedy, HasSubstr(GetParam().remedy));
}

INSTANTIATE_TEST_SUITE_P(
    Witnesses, OfMistakes,
    testing::Values(
        Compared{"rad", {0, 0, 1 / radian}, as_commanded, Witness::gyro, "rad/s", "scale_dps = 57.2958"},
        Compared{"degrees_as_rad",
                 {0, 0, radian},
                 as_commanded,
                 Witness::gyro,
                 "read as rad/s",
                 "scale_dps = 0.01745"},
        Compared{
            "counts_250", {0, 0, 131}, as_commanded, Witness::gyro, "range of 250", "scale_dps = 0.00763"},
        Compared{
            "counts_500", {0, 0, 65.5}, as_commanded, Witness::gyro, "65.5 a deg/s", "scale_dps = 0.01526"},
        Compared{
            "counts_1000", {0, 0, 32.8}, as_commanded, Witness::gyro, "32.8 a deg/s", "scale_dps = 0.0304"},
        Compared{
            "counts_2000", {0, 0, 16.4}, as_commanded, Witness::gyro, "16.4 a deg/s", "scale_dps = 0.0609"},
        Compared{"half", {0, 0, 0.5}, as_commanded, Witness::gyro, "twice what the profile", "scale_dps = 2"},
        Compared{"eighth", {0, 0, 0.125}, as_commanded, Witness::gyro, "eight times", "scale_dps = 8"},
        Compared{"fourfold", {0, 0, 4}, as_commanded, Witness::gyro, "a quarter", "scale_dps = 0.25"},
        Compared{"reversed", {0, 0, -1}, as_commanded, Witness::gyro, "other way round", "sign = -1"},
        Compared{
            "reversed_rad", {0, 0, -1 / radian}, as_commanded, Witness::gyro, "other way round", "57.2958"},
        Compared{
            "x_axis", {-1, 0, 0.01}, as_commanded, Witness::gyro, "x axis", "axis = \"x\" and sign = -1"},
        Compared{"dead", {0, 0, 0}, as_commanded, Witness::gyro, "no sensor", "wiring"},
        Compared{"leans", {0.71, 0, 0.71}, as_commanded, Witness::gyro, "leans by 45 deg", "mount"},
        Compared{"leans_reversed",
                 {0.71, 0, -0.71},
                 as_commanded,
                 Witness::gyro,
                 "the other way round",
                 "sign = -1"},
        Compared{"odd_scale", {0, 0, 0.72}, as_commanded, Witness::gyro, "scale", "calibrate scale"},
        Compared{"rad_blind",
                 {0, 0, 1 / radian},
                 std::nullopt,
                 Witness::undecided,
                 "too little to see",
                 "57.2958"},
        Compared{
            "reversed_blind", {0, 0, -1}, std::nullopt, Witness::undecided, "other way round", "sign = -1"},
        Compared{"weak_servo", {0, 0, 0.6}, Estimate{0.6, 0.01}, Witness::command, "a weak supply", "supply"},
        Compared{"no_power", {0, 0, 0}, Estimate{0.0, 0.01}, Witness::command, "does not turn", "supply"},
        Compared{"other_servo",
                 {0, 0, 1.5},
                 Estimate{1.52, 0.01},
                 Witness::command,
                 "another servo",
                 "travel_deg"},
        Compared{"backwards", {0, 0, -1}, Estimate{-1.0, 0.01}, Witness::command, "other way", "mirrored"},
        Compared{
            "mirrored", {0, 0, 1}, Estimate{-1.01, 0.01}, Witness::images, "mirrored", "mirrored = false"},
        Compared{
            "lens", {0, 0, 1}, Estimate{0.51, 0.01}, Witness::images, "110 deg", "field_of_view_deg = 110"},
        Compared{"frozen", {0, 0, 1}, Estimate{0.0, 0.01}, Witness::images, "stands still", "mounting"},
        Compared{
            "all", {0, 0, 2}, Estimate{-1.0, 0.01}, Witness::undecided, "the images -1", "scale_dps = 0.5"}),
    [](const auto& of) { return std::string(of.param.name); });

TEST(Witnesses, ThatAgreeWithinWhatTheProfileStatesHaveNoOutlier) {
  for (const double gyro : {0.93, 1.0, 1.07})
    for (const double images : {0.92, 1.0, 1.08}) {
      const Witnesses witnesses =
          Rig{.gyro_axes = {0.01, 0.0, gyro}, .images = Estimate{images, 0.01}}.compared();
      EXPECT_EQ(witnesses.outlier, Witness::none) << gyro << ' ' << images;
      EXPECT_EQ(witnesses.cause, "");
      EXPECT_NEAR(witnesses.gyro_share->value, gyro, 0.01);
    }
}

TEST(Witnesses, GyroAndImagesContradictWhereTheCommandCannotTell) {
  Rig rig{.gyro_axes = {0, 0, 0.8}, .images = Estimate{1.0, 0.01}};
  rig.profile.servo.scale_uncertainty = 0.16;
  EXPECT_EQ(rig.compared().outlier, Witness::undecided);
  EXPECT_THAT(rig.compared().cause, HasSubstr("gyro and images contradict"));
  rig.images = Estimate{0.82, 0.01};
  EXPECT_EQ(rig.compared().outlier, Witness::none);
}

TEST(Witnesses, OfAProtocolThatFixesTheUnitTheProfilesScaleIsOffered) {
  Rig rig{.gyro_axes = {0, 0, 0.5}};
  rig.profile.gyro.protocol = "witmotion";
  EXPECT_THAT(rig.compared().remedy, HasSubstr("or scale = 0.5 in [gyro]"));
}

TEST(Witnesses, OfOneDirectionAloneAreComparedOnceARestHasShownTheBias) {
  Rig rig{.gyro_axes = {0, 0, -1}, .images = {}, .rates_dps = {30}};
  EXPECT_EQ(rig.compared().outlier, Witness::undecided);
  rig.gyro_axes = {0, 0, 1};
  EXPECT_EQ(rig.compared().outlier, Witness::none);
}

TEST(Witnesses, AGyroAtTheEndOfItsRangeIsNoneThatAgrees) {
  const Witnesses witnesses = Rig{.rates_dps = {40, -40, 60, -60}, .range_dps = 41.0F}.compared();
  EXPECT_EQ(witnesses.outlier, Witness::gyro);
  EXPECT_THAT(witnesses.cause, HasSubstr("end of its range"));
}

TEST(Witnesses, TheProfilesOwnScaleIsNamedWhereItIsTheMistake) {
  Rig rig;
  rig.profile.gyro.scale = 2.0;
  const Witnesses witnesses = rig.compared();
  EXPECT_EQ(witnesses.outlier, Witness::gyro);
  EXPECT_THAT(witnesses.remedy, HasSubstr("scale = 1 in [gyro]"));
}

TEST(Witnesses, TheScaleOfRawCountsIsOfferedWhereTheProtocolHasOne) {
  Rig rig{.gyro_axes = {0, 0, 0.5}};
  rig.profile.gyro.protocol = "mavlink";
  rig.profile.gyro.settings = {{"raw_scale_dps", 0.0573}};
  EXPECT_THAT(rig.compared().remedy, HasSubstr("raw_scale_dps = 0.1146 in [gyro.mavlink]"));
}

TEST(Witnesses, WithoutLegsHaveNothingToCompare) {
  EXPECT_FALSE((Rig{.images = {}, .rates_dps = {}}.compared().gyro_share));
  EXPECT_EQ((Rig{.images = {}, .rates_dps = {}}.compared().outlier), Witness::none);
  EXPECT_FALSE(compare_witnesses({}, {}, {}, {}).gyro_share);
}

TEST(Witnesses, ComeBackFromTheirNames) {
  for (const Witness witness :
       {Witness::none, Witness::command, Witness::gyro, Witness::images, Witness::undecided})
    EXPECT_EQ(witness_named(name_of(witness)), witness);
  EXPECT_EQ(witness_named("nobody"), Witness::none);
}

ServoResponse fitted(const Rig& rig, const Witnesses& witnesses) {
  GyroErrors errors = fit_gyro_errors(rig.gyro(), rig.servo(), rig.profile.gyro);
  return fit_servo_response(rig.servo(), rig.gyro(), errors, rig.profile.servo, 0.125, witnesses);
}

TEST(Witnesses, NothingIsMadeOfAGyroThatIsTheOutlier) {
  const Rig rig{.gyro_axes = {0, 0, 1 / radian}};
  const ServoResponse response = fitted(rig, rig.compared());
  EXPECT_FALSE(response.fitted);
  EXPECT_EQ(response.scale, (Estimate{1.0, rig.profile.servo.scale_uncertainty}));
  for (const double rate_dps : rig.rates_dps)
    EXPECT_TRUE(contradicts_command(response, rate_dps)) << rate_dps;
}

TEST(Witnesses, WhereNobodyKnowsTheScaleIsAsUncertainAsTheContradiction) {
  const Rig rig{.gyro_axes = {0, 0, 0.4}, .images = {}};
  const ServoResponse response = fitted(rig, rig.compared());
  EXPECT_NEAR(response.scale.uncertainty, 0.6, 0.02);
  EXPECT_TRUE(contradicts_command(response, rig.rates_dps[0]));
}

}  // namespace
}  // namespace thermorig::fit
