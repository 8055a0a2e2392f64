// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "thermorig/fit/motion/panorama_fit.h"
#include "turning_rig.h"

namespace thermorig::motion {
namespace {

CameraOffset offset_of(const Turning& turning, const View& view = {}) {
  return camera_offset(turning.frames, turning.gyro, view, turning.errors);
}

/// Square sums of errors and of errors over stated uncertainties.
class Errors {
 public:
  void add(const Estimate& estimate, double truth) {
    const double error = estimate.value - truth;
    square_ += error * error;
    chi_square_ += std::pow(error / estimate.uncertainty, 2);
    ++count_;
  }
  double rms() const { return std::sqrt(square_ / count_); }
  double mean_chi_square() const { return chi_square_ / count_; }

 private:
  double square_ = 0.0;
  double chi_square_ = 0.0;
  int count_ = 0;
};

/// Delays from -20 to 20 ms, another one for each seed.
double delay_s(unsigned seed) {
  return 0.001 * (static_cast<double>(seed * 7 % 41) - 20.0);
}

Errors errors_over_seeds(unsigned seeds, double rate_dps, double leg_s) {
  Errors errors;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    Turning turning = turn(simulation::default_rig(seed, environment_of(seed)),
                           back_and_forth(rate_dps, leg_s, 62.0), 62.0);
    shift_frames(turning, delay_s(seed));
    const CameraOffset found = offset_of(turning);
    EXPECT_TRUE(found.offset_s) << seed << ": " << found.why_not;
    if (!found.offset_s) continue;
    EXPECT_NEAR(found.offset_s->value, delay_s(seed), 5.0 * found.offset_s->uncertainty) << seed;
    EXPECT_GT(found.halves, 200U);
    errors.add(*found.offset_s, delay_s(seed));
  }
  return errors;
}

TEST(CameraOffset, RowsThatAreReadOneAfterTheOtherAreSeenAndTheTimeIsThatOfTheMiddleOnes) {
  constexpr double refresh_s = 0.125;
  for (const double share : {-0.125, 0.125}) {
    auto config = simulation::default_rig(3, "kitchen");
    config.world.camera.rolling_rows = share;
    const CameraOffset found = offset_of(turn(config, back_and_forth(100.0, 1.5, 62.0), 62.0));
    ASSERT_TRUE(found.offset_s && found.row_delay_s) << found.why_not;
    EXPECT_TRUE(are_rows_apart(found));
    EXPECT_NEAR(found.row_delay_s->value, share * refresh_s / 24.0, 4.0 * found.row_delay_s->uncertainty);
    EXPECT_LT(found.row_delay_s->uncertainty, 0.3 * refresh_s / 8.0 / 24.0);
    EXPECT_NEAR(found.offset_s->value, 0.0, 0.004);
  }
}

TEST(CameraOffset, RowsThatAreReadTogetherAreNotSaidToBeApart) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const CameraOffset found = offset_of(
        turn(simulation::default_rig(seed, environment_of(seed)), back_and_forth(100.0, 1.5, 62.0), 62.0));
    EXPECT_FALSE(are_rows_apart(found)) << seed;
  }
}

TEST(CameraOffset, IsKnownToAMillisecondAfterAMinuteOfSweepsWithAnHonestUncertainty) {
  const Errors errors = errors_over_seeds(25, 100.0, 1.5);
  EXPECT_LT(errors.rms(), 0.001);
  EXPECT_LT(errors.mean_chi_square(), 2.0);
  EXPECT_GT(errors.mean_chi_square(), 0.1);
}

/// Fine structure that passes fast is less late than pixels with so long a lag are, and nothing tells by how
/// much but what coarse and fine structure say apart.
TEST(CameraOffset, IsLessSureOfPixelsThatLagForLong) {
  for (const unsigned seed : {1U, 4U}) {
    auto config = simulation::default_rig(seed, environment_of(seed));
    const auto found_at = [&](double lag_ms) {
      config.world.camera.membrane_lag_ms = lag_ms;
      return *offset_of(turn(config, back_and_forth(100.0, 1.5, 62.0), 62.0)).offset_s;
    };
    const Estimate usual = found_at(12.0), longer = found_at(40.0);
    EXPECT_LT(longer.value, -0.002) << seed;
    EXPECT_NEAR(longer.value, 0.0, 3.0 * longer.uncertainty) << seed;
    EXPECT_LT(usual.uncertainty, 0.001) << seed;
  }
}

TEST(CameraOffset, IsKnownFromTheLongLegsOfAnOrdinarySessionToo) {
  EXPECT_LT(errors_over_seeds(6, 150.0, 7.0).rms(), 0.001);
  EXPECT_LT(errors_over_seeds(4, 30.0, 7.0).rms(), 0.001);
}

TEST(CameraOffset, IsKnownForWideLensesFullFreshFramesAndRawGyros) {
  for (const unsigned seed : {1U, 2U, 3U, 4U}) {
    auto config = simulation::default_rig(seed, environment_of(seed));
    config.half_fresh = seed % 2 == 0;
    config.profile.camera.field_of_view_deg = 110.0;
    config.gyro_grade = simulation::GyroGrade::mpu6050_raw;
    Turning turning = turn(config, back_and_forth(90.0, 2.0, 62.0), 62.0);
    shift_frames(turning, delay_s(seed));
    const CameraOffset found = offset_of(turning, {110.0, true});
    ASSERT_TRUE(found.offset_s) << found.why_not;
    EXPECT_NEAR(found.offset_s->value, delay_s(seed), 0.002) << seed;
  }
}

TEST(CameraOffset, IsFoundFarFromWhatWasAssumed) {
  Turning turning = turn(simulation::default_rig(3, "kitchen"), back_and_forth(100.0, 2.0, 62.0), 62.0);
  shift_frames(turning, 0.18);
  const CameraOffset found = offset_of(turning);
  ASSERT_TRUE(found.offset_s) << found.why_not;
  EXPECT_NEAR(found.offset_s->value, 0.18, 0.002);
}

TEST(CameraOffset, NeedsNoBias) {
  Turning turning = turn(simulation::default_rig(6, "dining"), back_and_forth(100.0, 2.0, 62.0), 62.0);
  turning.errors.bias_dps.reset();
  const CameraOffset found = offset_of(turning);
  ASSERT_TRUE(found.offset_s) << found.why_not;
  EXPECT_NEAR(found.offset_s->value, 0.0, 0.002);
}

TEST(CameraOffset, IsAFramePeriodWrongWhereHeldHalvesAreTakenForFreshOnes) {
  Turning turning = turn(simulation::default_rig(2, "garden"), back_and_forth(100.0, 2.0, 62.0), 62.0);
  for (TimedFrame& frame : turning.frames) {
    std::swap(frame.fresh_even, frame.fresh_odd);
    std::swap(frame.half[0], frame.half[1]);
  }
  const CameraOffset found = offset_of(turning);
  ASSERT_TRUE(found.offset_s) << found.why_not;
  EXPECT_NEAR(found.offset_s->value, 0.1275, 0.003);  // which is why freshness is read from the pixels
}

TEST(CameraOffset, IsNotToldBeforeTheOrderOfTheHalvesIs) {
  auto config = simulation::default_rig(2, "garden");
  config.half_fresh = false;
  Turning turning = turn(config, back_and_forth(100.0, 2.0, 32.0), 32.0);
  for (TimedFrame& frame : turning.frames)
    frame.half.fill({frame.exposure_begin, frame.exposure_end});  // as long as the order is not known
  EXPECT_EQ(offset_of(turning).why_not, "which half of a frame is newer is not known");
}

TEST(CameraOffset, GapsInTheGyroAndLateFramesCostOnlyThemselves) {
  Turning turning = turn(simulation::default_rig(4, "garden"), back_and_forth(100.0, 2.0, 62.0), 62.0);
  std::erase_if(turning.gyro, [](const TimedGyro& sample) {
    const double time_s = to_s(sample.stamp.time.time_since_epoch());
    return (time_s > 20.0 && time_s < 21.0) || (time_s > 40.3 && time_s < 40.6);
  });
  for (std::size_t i = 0; i < turning.frames.size(); i += 9) {
    turning.frames[i].late = true;
    for (HalfExposure& half : turning.frames[i].half) half.begin += from_s(0.05), half.end += from_s(0.05);
  }
  const CameraOffset found = offset_of(turning);
  ASSERT_TRUE(found.offset_s) << found.why_not;
  EXPECT_NEAR(found.offset_s->value, 0.0, 0.0015);
}

/// As threads may do it: each at the same time, or the last one first.
void backwards(std::size_t count, const std::function<void(std::size_t)>& work) {
  for (std::size_t i = count; i-- > 0;) work(i);
}

TEST(CameraOffset, EqualInputGivesEqualOutputInWhateverOrderItIsWorkedOut) {
  const Turning turning =
      turn(simulation::default_rig(5, "laboratory"), back_and_forth(100.0, 2.0, 32.0), 32.0);
  const CameraOffset first = offset_of(turning);
  const CameraOffset second = offset_of(turning);
  const CameraOffset third = camera_offset(turning.frames, turning.gyro, {}, turning.errors, backwards);
  ASSERT_TRUE(first.offset_s && first.row_delay_s);
  EXPECT_EQ(*first.offset_s, *second.offset_s);
  EXPECT_EQ(*first.offset_s, *third.offset_s);
  EXPECT_EQ(*first.row_delay_s, *third.row_delay_s);
}

struct Silence {
  std::string name;
  std::vector<Leg> legs;
  std::string why_not;
};

TEST(CameraOffset, SaysWhyWhereMotionDoesNotTell) {
  const std::vector<Silence> silences{{"at rest", {}, "nothing turned"},
                                      {"one way", {{2.0, 8.0, 60.0}}, "one way"}};
  for (const Silence& silence : silences) {
    const CameraOffset found = offset_of(turn(simulation::default_rig(1, "garden"), silence.legs, 12.0));
    EXPECT_FALSE(found.offset_s) << silence.name;
    EXPECT_NE(found.why_not.find(silence.why_not), std::string::npos) << found.why_not;
  }
}

TEST(CameraOffset, IsNotMadeUpWhereImagesDoNotTurnWithTheGyro) {
  for (const unsigned seed : {1U, 4U}) {
    const auto config = simulation::default_rig(seed, environment_of(seed));
    const Turning one = turn(config, back_and_forth(100.0, 2.0, 62.0), 62.0);
    const Turning other = turn(config, back_and_forth(100.0, 2.3, 62.0), 62.0);
    const Turning still = turn(config, {}, 62.0);
    EXPECT_FALSE(camera_offset(one.frames, other.gyro, {}, other.errors).offset_s) << seed;
    const CameraOffset stuck = camera_offset(still.frames, one.gyro, {}, one.errors);
    EXPECT_FALSE(stuck.offset_s) << seed;
    EXPECT_NE(stuck.why_not.find("do not turn with the gyro"), std::string::npos);
  }
}

TEST(CameraOffset, IsNotMadeUpBeforeABlindWall) {
  Turning turning = turn(simulation::default_rig(1, "laboratory"), back_and_forth(100.0, 2.0, 62.0), 62.0);
  make_wall(turning, 0.6F);
  const CameraOffset found = offset_of(turning);
  EXPECT_FALSE(found.offset_s);
  EXPECT_NE(found.why_not.find("too little image detail"), std::string::npos) << found.why_not;
}

}  // namespace
}  // namespace thermorig::motion
