// SPDX-License-Identifier: MIT
// How an odometer starts.
#include <gtest/gtest.h>

#include <algorithm>

#include "reports.h"
#include "room.h"
#include "support/at_s.h"

namespace thermorig::odometer {
namespace {

TEST(OdometerStart, StartsInMotionAndFindsBiasScaleAndLatency) {
  const Room room = turning_room();
  const auto reports = reports_of(seen_in(room));
  EXPECT_EQ(reports[at(10.0)].state, EstimateState::starting);
  const Report& last = reports.back();
  EXPECT_EQ(last.state, EstimateState::good);
  EXPECT_NEAR(last.bias_dps, room.bias_dps, 0.05);
  EXPECT_NEAR(last.scale, room.scale, 0.001);
  EXPECT_NEAR(last.latency_s, room.latency_s, 0.001);
}

TEST(OdometerStart, StartsHoweverWellAProfileSaysThatItKnowsTheBias) {
  const Room room = turning_room(45.0);
  const auto all = seen_in(room);
  for (const double off_dps : {0.0, 8.0}) {  // measured just now; of another day, or of another gyro
    GyroProfile gyro = data_sheet_gyro();
    gyro.bias_dps = room.bias_dps + off_dps;
    gyro.bias_uncertainty_dps = 0.02;
    const Report last = reports_of(all, gyro).back();
    EXPECT_EQ(last.state, EstimateState::good) << off_dps;
    EXPECT_NEAR(last.bias_dps, room.bias_dps, 0.1) << off_dps;
  }
}

TEST(OdometerStart, BeginsAMapWithTheNoiseThatItHasHeardBefore) {
  Room room = turning_room();
  room.angle_deg = to_and_fro(300.0, 120.0);
  room.noise_k = 1.5;  // two and a half times what a data sheet says
  room.contrast_k = 1.6;
  const auto reports = reports_of(seen_in(room));
  const auto begins = std::find_if(reports.begin(), reports.end(),
                                   [](const Report& one) { return one.state == EstimateState::good; });
  ASSERT_NE(begins, reports.end());
  EXPECT_LT(begins->mean_nis, 0.6);
  EXPECT_NEAR(begins->scale, room.scale, 0.001);
}

TEST(OdometerStart, FindsInWhichOrderRowsAreExposed) {
  for (const double rolling : {0.0, 1.0, -1.0}) {
    Room room = turning_room();
    room.angle_deg = to_and_fro(300.0, 200.0);
    room.rolling = rolling;
    const auto reports = reports_of(seen_in(room));
    EXPECT_EQ(reports.back().rows, rows_of(room));
    EXPECT_GT(reports.back().row_margin, 10.0);
    EXPECT_EQ(reports.back().state, EstimateState::good);
    for (const Report& report : reports)  // what a start believes meanwhile may change
      EXPECT_EQ(report.row_margin > 0.0, report.state != EstimateState::starting);
    ASSERT_EQ(reports[at(54.0)].state, EstimateState::good);
    const double origin_deg = off_deg(room, reports, 54.0);
    for (double time_s = 54.0; time_s < 69.0; time_s += 0.5)
      EXPECT_NEAR(off_deg(room, reports, time_s), origin_deg, 0.5) << rolling << " at " << time_s;
    EXPECT_NEAR(reports.back().latency_s, room.latency_s + 0.0625 * std::abs(rolling), 0.002);
  }
}

/// The first search tells the gyro and no order, a later one the order: images of a slow rig hardly do.
TEST(OdometerStart, BeginsItsMapAgainWhereASearchTellsAnotherOrderOfRows) {
  for (const double rolling : {1.0, -1.0}) {
    Room room = turning_room(60.0);
    room.angle_deg = to_and_fro(60.0, 30.0);
    room.rolling = rolling;
    const auto reports = reports_of(seen_in(room));
    EXPECT_EQ(reports.back().state, EstimateState::good);
    EXPECT_EQ(reports.back().rows, rows_of(room));
  }
}

TEST(OdometerStart, StartsAtRest) {
  const Room room = with_rest(turning_room(58.0), 0.0, 12.0);
  const auto reports = reports_of(seen_in(room));
  EXPECT_NEAR(reports[at(11.0)].bias_dps, room.bias_dps, 0.3);
  EXPECT_EQ(reports.back().state, EstimateState::good);
  EXPECT_NEAR(reports.back().bias_dps, room.bias_dps, 0.05);
}

TEST(OdometerStart, TakesNoLongerAndFindsTheOrderOfRowsAsWellAfterALongRest) {
  Room room = turning_room(40.0);
  room.angle_deg = to_and_fro(300.0, 150.0);
  room.rolling = -1.0;
  const auto reports = reports_of(seen_in(with_rest(room, 0.0, 50.0)));
  EXPECT_EQ(reports[at(50.0)].state, EstimateState::starting);
  EXPECT_EQ(reports[at(85.0)].state, EstimateState::good);
  EXPECT_EQ(reports.back().rows, RowOrder::last_to_first);
}

TEST(OdometerStart, DoesNotTakeARestForTheMotionThatItLearnsFrom) {
  Room room = turning_room(70.0);
  room.angle_deg = to_and_fro(300.0, 150.0);
  room.rolling = 1.0;
  room = with_rest(room, 5.0, 31.0);
  const auto reports = reports_of(seen_in(room));
  EXPECT_EQ(reports[at(36.0)].state, EstimateState::starting);
  ASSERT_EQ(reports[at(97.0)].state, EstimateState::good);
  EXPECT_EQ(reports.back().rows, RowOrder::first_to_last);
  EXPECT_NEAR(off_deg(room, reports, 97.0), off_deg(room, reports, 100.0), 0.5);
  EXPECT_NEAR(reports.back().scale, room.scale, 0.001);
}

TEST(OdometerStart, StartsThoughTheBiasStepsInItsFirstSeconds) {
  const Room room = turning_room(60.0);
  auto all = seen_in(room);
  for (Seen& seen : all)
    for (TimedGyro& sample : seen.gyro)
      if (sample.stamp.time < at_s(12.0)) sample.rate_dps += 12.0F;
  const auto reports = reports_of(all);
  EXPECT_GT(share_tracked(reports, 53.0), 0.9);
  EXPECT_NEAR(reports.back().bias_dps, room.bias_dps, 0.1);
}

/// The first search names +24 deg/s: no pass fits until a later one knows the scale as well.
TEST(OdometerStart, KeepsTheHalvesOfAStartUntilSearchesKnowTheScale) {
  Room room = faint_room(50.0, 0.25);
  room.walls = 1;
  room.angle_deg = to_and_fro(250.0, 120.0);
  auto all = seen_in(room);
  let_walk(room, 20.0, all);
  const auto reports = reports_of(all);
  EXPECT_EQ(reports[at(42.0)].state, EstimateState::good);
  EXPECT_NEAR(reports[at(42.0)].bias_dps, room.bias_dps, 0.2);
}

/// Before faint walls: since the last half that it keeps the gyro alone tells the heading.
TEST(OdometerStart, ProvesTheHeadingFirstWhereAStartOutlastsTheMinuteThatItKeeps) {
  Room room = faint_room(100.0, 0.3);
  room.noise_k = 0.9;
  room.rolling = 1.0;
  const auto reports = reports_of(seen_in(room));
  const auto state_is = [](EstimateState state) {
    return [state](const Report& one) { return one.state == state; };
  };
  const auto ends = std::find_if_not(reports.begin(), reports.end(), state_is(EstimateState::starting));
  ASSERT_GT(ends, reports.begin() + static_cast<long>(at(65.0)));
  ASSERT_NE(ends, reports.end());
  EXPECT_EQ(ends->state, EstimateState::relocalising);
  const auto tracks = std::find_if(ends, reports.end(), state_is(EstimateState::good));
  ASSERT_LT(tracks, ends + 16);
  EXPECT_LT(tracks->heading_sigma_deg, 0.7 * ends->heading_sigma_deg);
  EXPECT_NEAR(off_deg(room, reports, 90.0), off_deg(room, reports, 75.0), 0.5);
}

TEST(OdometerStart, TracksThoughSomeoneWalksAround) {
  const Room room = faint_room(70.0, 0.3);
  auto all = seen_in(room);
  let_walk(room, 20.0, all);
  const auto reports = reports_of(all);
  EXPECT_GT(share_tracked(reports, 62.0), 0.9);
  ASSERT_EQ(reports[at(62.0)].state, EstimateState::good);
  EXPECT_LT(silent_s(room, reports, 62.0), 0.5);
}

/// With a latency that nobody measured, so that passes fit badly anyway.
TEST(OdometerStart, TracksThoughSomeoneWalksAroundAFastRigWhoseLatencyIsOff) {
  Room room = faint_room(70.0, 0.3);
  room.walls = 10;
  room.angle_deg = to_and_fro(250.0, 100.0);
  room.latency_s = 0.03;
  auto all = seen_in(room);
  let_walk(room, 20.0, all);
  CameraProfile measured;
  measured.lens_measured_utc = "2026-11-01T00:00:00Z";
  const auto reports = reports_of(all, data_sheet_gyro(), measured);
  EXPECT_GT(share_tracked(reports, 42.0), 0.9);
  EXPECT_LT(silent_s(room, reports, 42.0), 0.5);
}

/// Of walls that show next to nothing a map of the person alone would fit: with another bias of the gyro.
TEST(OdometerStart, DoesNotTakeSomeoneWhoWalksForTheWalls) {
  const Room room = faint_room(100.0, 0.15);
  auto all = seen_in(room);
  let_walk(room, 20.0, all);
  for (const Report& report : reports_of(all))
    if (report.state == EstimateState::good) {
      ASSERT_NEAR(report.bias_dps, room.bias_dps, 3.0);
    }
}

TEST(OdometerStart, NeverSaysThatItTracksBeforeABlankWall) {
  Room room = turning_room();
  room.contrast_k = 0.0;
  for (const Report& report : reports_of(seen_in(room))) EXPECT_NE(report.state, EstimateState::good);
}

/// So faint that a map may close by itself, and the halves of its start lie anywhere: by their own sigmas
/// that is no surprise.
TEST(OdometerStart, NeverSaysThatItTracksInAFalseMap) {
  Room room = turning_room(56.0);
  room.angle_deg = to_and_fro(200.0, 150.0);
  room.contrast_k = 0.11;
  room.walls = 8;
  for (const Report& report : reports_of(seen_in(room))) EXPECT_NE(report.state, EstimateState::good);
}

TEST(OdometerStart, BelievesAGyroThatNoDataSheetKnowsOnceASecondStartSaysTheSame) {
  Room room = turning_room(100.0);
  room.scale = 1.12;
  const auto reports = reports_of(seen_in(room));
  for (double time_s = 1.0; time_s < 50.0; time_s += 0.25)
    EXPECT_NE(reports[at(time_s)].state, EstimateState::good);
  EXPECT_EQ(reports.back().state, EstimateState::good);
  EXPECT_NEAR(reports.back().scale, room.scale, 0.002);
}

/// The second one no data sheet knows, but the mosaic of the start names it, too.
TEST(OdometerStart, BelievesAGyroAtOnceThatADataSheetOrAMosaicKnows) {
  for (const double scale : {1.05, 1.08}) {
    Room room = turning_room(40.0);
    room.scale = scale;
    const Report last = reports_of(seen_in(room)).back();
    EXPECT_EQ(last.state, EstimateState::good);
    EXPECT_NEAR(last.scale, scale, 0.002);
  }
}

}  // namespace
}  // namespace thermorig::odometer
