// SPDX-License-Identifier: MIT
#include "board_odometer.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "board_room.h"
#include "boards.h"
#include "support/at_s.h"
#include "thermorig/core/error.h"

namespace thermorig::tests {
namespace {

using odometer::Room;
using odometer::Seen;
using ::testing::HasSubstr;

/// A gyro of whose bias and scale a data sheet tells, and the lens of the room.
RigProfile data_sheet_rig() {
  RigProfile rig;
  rig.gyro.bias_uncertainty_dps = 10.0;
  rig.gyro.bandwidth_hz = 8000.0;  // no low-pass
  return rig;
}

struct Said {
  EstimateState state;
  thermorig_odometer_output output;
  double heading_deg;
};

std::vector<Said> said_of(const std::vector<Seen>& all, const RigProfile& rig = data_sheet_rig()) {
  BoardOdometer board(rig);
  std::vector<Said> said;
  for (const Seen& seen : all) {
    const RateEstimate estimate = board.add(seen.frame, seen.gyro);
    said.push_back({estimate.state, board.output(), estimate.angle_deg});
  }
  return said;
}

std::size_t at(double time_s) {
  return static_cast<std::size_t>(time_s / 0.125) - 2;
}

/// Heading less the shaft's angle.
double off_deg(const Room& room, const std::vector<Said>& said, double time_s) {
  return said[at(time_s)].heading_deg - room.angle_deg(0.125 * static_cast<double>(at(time_s) + 2));
}

TEST(BoardOdometer, StartsInMotionAndHoldsTheHeading) {
  const Room room = turning_room(90.0);
  const auto said = said_of(seen_in(room));
  EXPECT_EQ(said[at(10.0)].state, EstimateState::starting);
  ASSERT_EQ(said[at(60.0)].state, EstimateState::good);
  const double origin_deg = off_deg(room, said, 60.0);
  for (double time_s = 60.0; time_s < 89.0; time_s += 0.5) {  // the gyro alone: 4 deg/s
    EXPECT_NEAR(off_deg(room, said, time_s), origin_deg, 0.6) << time_s;
    EXPECT_LT(said[at(time_s)].output.heading_sigma_deg, 0.6F);
  }
  EXPECT_NEAR(said.back().output.bias_dps, room.bias_dps, 0.1);
  EXPECT_NEAR(said.back().output.scale, room.scale, 0.002);
  EXPECT_NEAR(said.back().output.latency_s, room.latency_s, 0.0015);
}

TEST(BoardOdometer, StartsHoweverWellAProfileSaysThatItKnowsTheBias) {
  const Room room = turning_room(90.0);
  const auto all = seen_in(room);
  for (const double off_dps : {0.0, 8.0}) {  // measured just now; of another day, or of another gyro
    RigProfile rig = data_sheet_rig();
    rig.gyro.bias_dps = room.bias_dps + off_dps;
    rig.gyro.bias_uncertainty_dps = 0.02;
    EXPECT_EQ(said_of(all, rig).back().state, EstimateState::good) << off_dps;
  }
}

/// The lens alone tells its scale then: no turn is closed.
TEST(BoardOdometer, LearnsTheGyroOnAServoThatTurnsHalfWayRoundOnly) {
  Room room = turning_room(90.0);
  room.angle_deg = odometer::to_and_fro(60.0, 60.0);
  const auto said = said_of(seen_in(room));
  EXPECT_EQ(said.back().state, EstimateState::good);
  EXPECT_NEAR(said.back().output.scale, room.scale, 0.004);
}

TEST(BoardOdometer, StartsAtRest) {
  const Room room = with_rest(turning_room(68.0), 0.0, 12.0);
  const auto said = said_of(seen_in(room));
  EXPECT_NEAR(said[at(11.0)].output.bias_dps, room.bias_dps, 0.3);
  EXPECT_EQ(said.back().state, EstimateState::good);
  EXPECT_NEAR(said.back().output.bias_dps, room.bias_dps, 0.1);
}

TEST(BoardOdometer, DoesNotTakeARestForTheMotionThatItLearnsFrom) {
  Room room = turning_room(70.0);
  room.angle_deg = odometer::to_and_fro(300.0, 150.0);
  const auto said = said_of(seen_in(with_rest(room, 11.0, 40.0)));
  EXPECT_EQ(said[at(51.0)].state, EstimateState::starting);
  EXPECT_EQ(said.back().state, EstimateState::good);
}

TEST(BoardOdometer, IsLessSureOfTheHeadingWhereGearsShakeTheGyro) {
  auto all = seen_in(turning_room(60.0));
  const Said still = said_of(all).back();
  shake(all);
  const Said shaken = said_of(all).back();
  ASSERT_EQ(shaken.state, EstimateState::good);
  EXPECT_GT(shaken.output.heading_sigma_deg, 1.2F * still.output.heading_sigma_deg);
}

TEST(BoardOdometer, SaysThatTheGyroIsFrozenAndFindsTheHeadingAgainInTheMap) {
  const Room room = turning_room(95.0);
  auto all = seen_in(room);
  std::optional<TimedGyro> frozen;
  for (Seen& seen : all)
    for (TimedGyro& sample : seen.gyro) {
      if (sample.stamp.time < at_s(70.0) || sample.stamp.time > at_s(80.0)) continue;
      if (!frozen) frozen = sample;
      sample.rate_dps = frozen->rate_dps;
      sample.reading = frozen->reading;
    }
  const auto said = said_of(all);
  ASSERT_EQ(said[at(69.0)].state, EstimateState::good);
  EXPECT_EQ(said[at(71.0)].output.reason, THERMORIG_ODOMETER_GYRO_FROZEN);
  EXPECT_EQ(said[at(81.0)].state, EstimateState::relocalising);
  EXPECT_EQ(said[at(90.0)].state, EstimateState::good);
  const double jump_deg = off_deg(room, said, 90.0) - off_deg(room, said, 69.0);
  EXPECT_NEAR(std::remainder(jump_deg, 360.0), 0.0, 0.7);
}

TEST(BoardOdometer, SaysThatTheLensIsCoveredAndDoesNotWriteThatIntoItsMap) {
  const Room room = turning_room(90.0);
  auto all = seen_in(room);
  unsigned noise = 1;
  for (Seen& seen : all) {
    if (seen.frame.exposure_end < at_s(70.0) || seen.frame.exposure_end > at_s(80.0)) continue;
    for (float& temp_c : seen.frame.frame.temp_c) {
      noise = noise * 1664525U + 1013904223U;
      temp_c = 30.0F + 1e-4F * static_cast<float>(noise >> 20U);
    }
  }
  const auto said = said_of(all);
  EXPECT_EQ(said[at(72.0)].output.reason, THERMORIG_ODOMETER_VIEW_DIFFERS);
  EXPECT_EQ(said[at(82.0)].state, EstimateState::good);
  EXPECT_NEAR(off_deg(room, said, 82.0), off_deg(room, said, 69.0), 0.5);
}

/// At a steady speed images whose time is wrong fit where the rig is not.
TEST(BoardOdometer, DoubtsWhatTheGyroContradictsAndNotWhatItConfirms) {
  const Room room = with_steady_speed(turning_room(90.0), 70.0, 30.0);
  auto all = seen_in(room);
  make_early(all, 74.0, 80.0);
  const auto said = said_of(all);
  ASSERT_EQ(said[at(69.0)].state, EstimateState::good);
  EXPECT_EQ(said[at(79.5)].state, EstimateState::relocalising);
  EXPECT_EQ(said[at(86.0)].state, EstimateState::good);
  EXPECT_NEAR(off_deg(room, said, 86.0), off_deg(room, said, 69.0), 0.7);
}

/// From 70 s on the walls show little of what they showed.
TEST(BoardOdometer, SaysInANewMapHowWellTheGyroHasCarriedTheHeadingThere) {
  const Room room = turning_room(190.0);
  auto all = seen_in(room);
  change_walls(room, 70.0, 0.8F, all);
  const auto said = said_of(all);
  ASSERT_EQ(said[at(69.0)].state, EstimateState::good);
  EXPECT_LT(said[at(69.0)].output.heading_sigma_deg, 0.7F);
  ASSERT_EQ(said.back().state, EstimateState::good);
  const double sigma_deg = double{said.back().output.heading_sigma_deg};
  EXPECT_GT(sigma_deg, 0.7);
  EXPECT_LT(sigma_deg, 3.0);
  EXPECT_NEAR(off_deg(room, said, 189.0), off_deg(room, said, 69.0), 2.0 * sigma_deg);
}

TEST(BoardOdometer, SaysThatNothingComes) {
  auto all = seen_in(turning_room(80.0));
  for (Seen& seen : all) {
    if (seen.frame.exposure_end > at_s(70.0)) seen.frame.fresh_even = seen.frame.fresh_odd = 0;
    if (seen.frame.exposure_end > at_s(75.0)) seen.gyro.clear();
  }
  const auto said = said_of(all);
  EXPECT_EQ(said[at(69.0)].state, EstimateState::good);
  EXPECT_EQ(said[at(72.0)].output.reason, THERMORIG_ODOMETER_NO_CAMERA);
  EXPECT_EQ(said[at(76.0)].output.reason, THERMORIG_ODOMETER_NO_GYRO);
}

TEST(BoardOdometer, NeverSaysThatItTracksBeforeABlankWall) {
  Room room = turning_room(90.0);
  room.contrast_k = 0.0;
  for (const Said& one : said_of(seen_in(room))) EXPECT_NE(one.state, EstimateState::good);
}

TEST(BoardOdometer, TellsTheHeadingBetweenFramesByTheGyro) {
  const Room room = turning_room(70.0);
  BoardOdometer board(data_sheet_rig());
  for (const Seen& seen : seen_in(room)) board.add(seen.frame, seen.gyro);
  const thermorig_odometer_output now = board.output(), later = board.read_after(0.02);
  const double turned_deg = room.angle_deg(70.02) - room.angle_deg(70.0);
  EXPECT_GT(std::abs(turned_deg), 0.3);
  EXPECT_NEAR(std::remainder(later.heading_deg - now.heading_deg, 360.0), turned_deg, 0.05);
  EXPECT_GE(later.heading_sigma_deg, now.heading_sigma_deg);
}

TEST(BoardOdometer, SaysTheSameWhenItsClockWrapsAround) {
  BoardOdometer early(data_sheet_rig()),
      late(data_sheet_rig(), std::chrono::microseconds(0xFFFF0000U - 10'000'000U));
  for (const Seen& seen : seen_in(turning_room(20.0))) {
    early.add(seen.frame, seen.gyro);
    late.add(seen.frame, seen.gyro);
    ASSERT_EQ(late.output().heading_deg, early.output().heading_deg);
    ASSERT_EQ(late.output().reason, early.output().reason);
  }
}

/// As a bad cable may have them: broken pixels, absurd rates, clocks that jump.
TEST(BoardOdometer, BearsWhatNoSensorSends) {
  auto all = seen_in(turning_room(60.0));
  constexpr float nan = std::numeric_limits<float>::quiet_NaN(), huge = std::numeric_limits<float>::max();
  for (std::size_t i = 0; i < all.size(); ++i) {
    TimedFrame& frame = all[i].frame;
    for (std::size_t pixel = i % 7; pixel < frame_pixels; pixel += 97)
      frame.frame.temp_c[pixel] = i % 3 == 0 ? nan : i % 3 == 1 ? huge : -huge;
    if (i % 11 == 3) frame.half[i % 2].end += std::chrono::hours(20);
    if (i % 13 == 5) frame.half[i % 2].begin -= std::chrono::minutes(50);
    for (TimedGyro& sample : all[i].gyro) {
      if (i % 17 == 2) sample.rate_dps = i % 2 == 0 ? nan : -huge;
      if (i % 19 == 4) sample.rate_dps = 9999.0F;
      if (i == at(40.0)) sample.stamp.time -= std::chrono::minutes(3);
      if (i == at(50.0)) sample.stamp.time += std::chrono::minutes(40);
    }
  }
  for (const Said& one : said_of(all)) {
    EXPECT_TRUE(std::isfinite(one.heading_deg));
    EXPECT_GE(one.output.heading_sigma_deg, 0.0F);
  }
}

TEST(BoardOdometer, IgnoresAndCountsWhatIsNoNumber) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  const Room room = turning_room(60.0);
  auto all = seen_in(room);
  const auto sound = said_of(all);
  const std::size_t frame = at(50.0), sample = at(51.0);
  all[frame].frame.stamp.uncertainty_s = nan;
  all[frame + 5].frame.stamp.uncertainty_s = std::numeric_limits<float>::infinity();
  all[sample].gyro.front().reading.rate_dps = {nan, nan, nan};
  all[sample].gyro.front().rate_dps = nan;
  const auto said = said_of(all);
  EXPECT_EQ(said[frame - 1].output.ignored, 0U);
  EXPECT_EQ(said.back().output.ignored, 3U);
  EXPECT_TRUE(std::isfinite(said.back().output.nis));
  EXPECT_EQ(said.back().state, sound.back().state);
  EXPECT_NEAR(said.back().heading_deg, sound.back().heading_deg, 0.5);
}

/// The text that is written out, under another name, and the library that tests use are the same.
TEST(BoardOdometerSource, CompilesStrictlyAndSaysTheSame) {
  const RigProfile rig = data_sheet_rig();
  const auto all = seen_in(turning_room(12.0));
  const auto source = board_odometer::odometer_source(rig, "thermal");
  const auto said = said_of(all);
  const std::string recording = recording_of(all, rig);
  for (const std::string& compiler :
       {"cc" + std::string(strict_c99), std::string("c++ -x c++ -std=c++11 -O2 -Wall -Wextra -Wconversion "
                                                    "-Wno-missing-field-initializers -ffp-contract=off "
                                                    "-Werror -pedantic")}) {
    const OdometerRun run = run_odometer_on({.compiler = compiler}, source, recording);
    ASSERT_TRUE(run.failure.empty()) << run.failure;
    EXPECT_EQ(run.state_bytes, source.state_bytes);
    ASSERT_EQ(run.frames.size(), said.size());
    for (std::size_t i = 0; i < said.size(); ++i)
      ASSERT_NEAR(run.frames[i].output.heading_deg, said[i].output.heading_deg, 0.01F) << i;
  }
}

TEST(BoardOdometerSource, NeedsNoFileButItsHeader) {
  const std::string text = board_odometer::odometer_source(RigProfile(), "odo").files.at(1).text;
  for (const char* part :
       {"#include \"odo.h\"\n", "---- gyro path ----", "---- heading filter ----", "void odo_read"})
    EXPECT_EQ(text.find(part), text.rfind(part)) << part;
  EXPECT_THAT(text, HasSubstr("---- tracker ----"));
  EXPECT_EQ(text.find("#include \""), text.rfind("#include \""));
  EXPECT_EQ(text.find("#pragma"), std::string::npos);
}

TEST(BoardOdometerSource, HasTheConstantsOfTheRig) {
  RigProfile rig;
  rig.name = "bench */ int x; /*";
  rig.camera.mirrored = false;
  rig.gyro.axis = 1;
  rig.gyro.sign = -1;
  rig.gyro.bias_dps = -1.25;
  rig.gyro.bias_uncertainty_dps = 1.5;  // and 2 deg/s by which it moves until another day
  rig.gyro.bias_measured_utc = "2026-03-01";
  const std::string text = board_odometer::odometer_source(rig, "odo").files.back().text;
  for (const char* part : {"static const odo_profile odo_rig", "1.71875f", "1, -1,", "-1.25f, 2.5f",
                           "measured 2026-03-01", "an assumption", "bench * / int x; / *"})
    EXPECT_THAT(text, HasSubstr(part));
}

TEST(BoardOdometerSource, RefusesNamesAndRigsThatDoNotFit) {
  EXPECT_THROW(board_odometer::odometer_source(RigProfile(), "2nd"), Error);
  RigProfile rig;
  rig.camera.field_of_view_deg = 20.0;
  EXPECT_THROW(board_odometer::odometer_source(rig, "odo"), Error);
  rig.camera.field_of_view_deg = 110.0;
  EXPECT_NO_THROW(board_odometer::odometer_source(rig, "odo"));
  rig.camera.output_rate_hz = 0.25;
  EXPECT_THROW(board_odometer::odometer_source(rig, "odo"), Error);
}

}  // namespace
}  // namespace thermorig::tests
