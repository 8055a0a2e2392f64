// SPDX-License-Identifier: MIT
#include "thermorig/estimators/odometer/odometer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "../network/allocations.h"
#include "reports.h"
#include "room.h"
#include "support/at_s.h"

namespace thermorig::odometer {
namespace {

/// A lens that was measured tells its scale then: no turn is closed.
TEST(Odometer, LearnsTheGyroOnAServoThatTurnsHalfWayRoundOnly) {
  Room room = turning_room(60.0);
  room.angle_deg = to_and_fro(90.0, 100.0);
  CameraProfile camera;
  camera.pitch_scale_uncertainty = 0.005;
  const auto reports = reports_of(seen_in(room), data_sheet_gyro(), camera);
  ASSERT_EQ(reports[at(45.0)].state, EstimateState::good);
  EXPECT_NEAR(reports.back().scale, room.scale, 0.005);
  const double origin_deg = off_deg(room, reports, 45.0);
  for (double time_s = 45.0; time_s < 59.0; time_s += 0.5)
    EXPECT_NEAR(off_deg(room, reports, time_s), origin_deg, 0.8) << time_s;
}

TEST(Odometer, HoldsTheHeadingWhileTheGyroWalksAway) {
  const Room room = turning_room();
  const auto reports = reports_of(seen_in(room));
  ASSERT_EQ(reports[at(40.0)].state, EstimateState::good);
  const double origin_deg = off_deg(room, reports, 40.0);
  for (double time_s = 40.0; time_s < 69.0; time_s += 0.5) {  // the gyro alone: 4 deg/s
    EXPECT_NEAR(off_deg(room, reports, time_s), origin_deg, 0.5) << time_s;
    EXPECT_LT(reports[at(time_s)].heading_sigma_deg, 0.5);
  }
}

TEST(Odometer, SaysHowFarOffALowPassThatNobodyStatedMayMakeTheHeading) {
  const Room room = turning_room(12.0);
  GyroProfile gyro = data_sheet_gyro();
  gyro.bandwidth_hz = 0.0;
  Odometer odometer(gyro, CameraProfile());
  Report last;
  for (const Seen& seen : seen_in(room)) last = odometer.add(seen.frame, seen.gyro);
  EXPECT_GT(last.heading_sigma_deg, 0.015 * std::abs(last.rate_dps));
}

/// Root mean square of a frame against the map around an azimuth, in K.
double misfit_k(const ThermalFrame& frame, const std::vector<float>& map_c, double azimuth_deg) {
  const std::size_t columns = map_c.size() / frame_rows;
  double sum = 0.0;
  for (std::size_t column = 0; column < frame_columns; ++column) {
    const double turns = (azimuth_deg + (15.5 - static_cast<double>(column)) * 55.0 / 32.0) / 360.0;
    const auto place = static_cast<std::size_t>((turns - std::floor(turns)) * static_cast<double>(columns));
    for (std::size_t row = 0; row < frame_rows; ++row) {
      const double off_k =
          double{frame.temp_c[row * frame_columns + column]} - double{map_c[row * columns + place]};
      sum += off_k * off_k;
    }
  }
  return std::sqrt(sum / static_cast<double>(frame_pixels));
}

TEST(Odometer, ItsMapIsAnImageOfTheRoomWithHolesWhereItNeverLooked) {
  Room room = turning_room(50.0);
  room.noise_k = 0.1;
  room.angle_deg = [turning = to_and_fro(50.0, 40.0)](double time_s) {
    return turning(std::min(time_s, 47.0));  // it rests at the end: the newest frame is sharp
  };
  Odometer odometer(data_sheet_gyro(), CameraProfile());
  EXPECT_TRUE(odometer.map_image_c().empty());
  Report last;
  const auto all = seen_in(room);
  for (const Seen& seen : all) last = odometer.add(seen.frame, seen.gyro);
  const std::vector<float> map_c = odometer.map_image_c();
  const ThermalFrame& newest = all.back().frame.frame;
  EXPECT_LT(misfit_k(newest, map_c, last.heading_deg), 0.3);
  EXPECT_GT(misfit_k(newest, map_c, last.heading_deg + 20.0), 0.6);
  const std::size_t columns = map_c.size() / frame_rows;
  EXPECT_TRUE(std::isnan(map_c[columns / 2])) << "behind it";
  const auto holes = std::count_if(map_c.begin(), map_c.end(), [](float one) { return std::isnan(one); });
  // Of 360 degrees it turned over 100 and sees 55.
  EXPECT_NEAR(static_cast<double>(holes) / static_cast<double>(map_c.size()), 205.0 / 360.0, 0.1);
}

/// As a damaged file may have them: its times are within 31 years, in any order.
TEST(Odometer, BearsTimesThatJumpByYearsAndExposuresThatLastAsLong) {
  auto all = seen_in(turning_room(50.0));
  const auto years = std::chrono::hours(24 * 365 * 30);
  for (std::size_t i = at(30.0); i < all.size(); ++i) {
    TimedFrame& frame = all[i].frame;
    if (i % 16 == 3) frame.half[0].end += years;
    if (i % 16 == 7) frame.half[1].begin -= years;
    if (i < at(35.0)) continue;
    for (HalfExposure& half : frame.half) half.begin += years, half.end += years;
    frame.exposure_end += years;
    if (i < at(40.0) || i % 3 == 0) continue;
    for (TimedGyro& sample : all[i].gyro) sample.stamp.time += years;
  }
  for (const Report& report : reports_of(all)) EXPECT_FALSE(report.heading_sigma_deg < 0.0);
}

TEST(Odometer, SaysThatTheGyroIsFrozenAndFindsTheHeadingAgainInTheMap) {
  const Room room = turning_room();
  auto all = seen_in(room);
  std::optional<TimedGyro> frozen;
  for (Seen& seen : all)
    for (TimedGyro& sample : seen.gyro) {
      if (sample.stamp.time < at_s(45.0) || sample.stamp.time > at_s(55.0)) continue;
      if (!frozen) frozen = sample;
      sample.rate_dps = frozen->rate_dps;
      sample.reading = frozen->reading;
    }
  const auto reports = reports_of(all);
  ASSERT_EQ(reports[at(44.0)].state, EstimateState::good);
  EXPECT_EQ(reports[at(46.0)].state, EstimateState::not_trusted);
  EXPECT_EQ(reports[at(46.0)].reason, EstimateReason::gyro_frozen);
  EXPECT_EQ(reports[at(56.0)].state, EstimateState::relocalising);
  EXPECT_EQ(reports[at(65.0)].state, EstimateState::good);
  const double before_deg = off_deg(room, reports, 44.0), after_deg = off_deg(room, reports, 65.0);
  EXPECT_NEAR(std::remainder(after_deg - before_deg, 360.0), 0.0, 0.7);
}

TEST(Odometer, SaysThatTheLensIsCoveredAndDoesNotWriteThatIntoItsMap) {
  const Room room = turning_room();
  auto all = seen_in(room);
  unsigned noise = 1;
  for (Seen& seen : all) {
    if (seen.frame.exposure_end < at_s(45.0) || seen.frame.exposure_end > at_s(55.0)) continue;
    for (float& temp_c : seen.frame.frame.temp_c) {
      noise = noise * 1664525U + 1013904223U;
      temp_c = 30.0F + 1e-4F * static_cast<float>(noise >> 20U);
    }
  }
  const auto reports = reports_of(all);
  EXPECT_EQ(reports[at(47.0)].state, EstimateState::not_trusted);
  EXPECT_EQ(reports[at(47.0)].reason, EstimateReason::view_differs);
  EXPECT_EQ(reports[at(57.0)].state, EstimateState::good);
  EXPECT_NEAR(off_deg(room, reports, 57.0), off_deg(room, reports, 44.0), 0.5);
}

TEST(Odometer, LearnsALatencyAnewThatNobodyExpectsAndThatDoesNotFitAtAnotherSpeed) {
  const Room room = faint_room(120.0, 0.3);
  auto all = seen_in(room);
  for (Seen& seen : all) {
    const auto late = std::chrono::milliseconds(seen.frame.exposure_end < at_s(70.0) ? 40 : 60);
    for (HalfExposure& half : seen.frame.half) {
      half.begin += late;
      half.end += late;
    }
  }
  const auto reports = reports_of(all);
  ASSERT_EQ(reports[at(69.0)].state, EstimateState::good);
  EXPECT_EQ(reports.back().state, EstimateState::good);
  EXPECT_NEAR(reports.back().latency_s - reports[at(69.0)].latency_s, 0.020, 0.005);
  EXPECT_NEAR(off_deg(room, reports, 119.0), off_deg(room, reports, 69.0), 0.7);
}

/// Before faint walls a half whose time is wrong fits elsewhere.
TEST(Odometer, KeepsTheHeadingOfTheGyroWhenImagesHaveWrongTimes) {
  const Room room = faint_room(120.0, 0.3);
  auto all = seen_in(room);
  make_early(all, 70.0, 100.0);
  const auto reports = reports_of(all);
  ASSERT_EQ(reports[at(69.0)].state, EstimateState::good);
  EXPECT_NE(reports[at(73.0)].state, EstimateState::good);
  EXPECT_LT(silent_s(room, reports, 69.0), 1.0);
  EXPECT_EQ(reports.back().state, EstimateState::good);
  EXPECT_NEAR(off_deg(room, reports, 119.0), off_deg(room, reports, 69.0), 0.7);
}

/// At a steady speed halves whose time is wrong fit where the rig is not, and the gyro says so.
TEST(Odometer, BelievesWhatTheGyroConfirmsAtTheSameSpeedAndNothingElse) {
  const Room room = with_steady_speed(turning_room(90.0), 70.0, 30.0);
  auto all = seen_in(room);
  make_early(all, 74.0, 80.0);
  const auto reports = reports_of(all);
  EXPECT_LT(silent_s(room, reports, 69.0), 1.0);
  EXPECT_EQ(reports[at(79.5)].state, EstimateState::relocalising);
  EXPECT_EQ(reports[at(84.0)].state, EstimateState::good);
  EXPECT_NEAR(off_deg(room, reports, 84.0), off_deg(room, reports, 69.0), 0.7);
}

TEST(Odometer, TracksThoughSomeoneComesAfterTheStart) {
  const Room room = faint_room(170.0, 0.3);
  auto all = seen_in(room);
  let_walk(room, 20.0, all, 45.0);
  const auto reports = reports_of(all);
  ASSERT_EQ(reports[at(44.0)].state, EstimateState::good);
  EXPECT_GT(share_tracked(reports, 90.0), 0.7);  // 61 % if it is not taken for traffic
  EXPECT_LT(silent_s(room, reports, 44.0), 0.5);
}

TEST(Odometer, SaysThatNoNewImageComes) {
  auto all = seen_in(turning_room());
  for (Seen& seen : all)
    if (seen.frame.exposure_end > at_s(45.0)) seen.frame.fresh_even = seen.frame.fresh_odd = 0;
  const auto reports = reports_of(all);
  EXPECT_EQ(reports[at(44.0)].state, EstimateState::good);
  EXPECT_EQ(reports[at(46.5)].reason, EstimateReason::no_image);
  EXPECT_GT(reports[at(69.0)].heading_sigma_deg, 2.0 * reports[at(46.0)].heading_sigma_deg);
}

/// For 45 s the times of images jump by 8 ms from frame to frame, so that each is up to half a degree off.
TEST(Odometer, KeepsAMapThatTheGyroConfirmsThoughImagesHaveNotFittedForLong) {
  Room room = turning_room(120.0);
  room.angle_deg = to_and_fro(300.0, 120.0);
  room.noise_k = 0.2;
  auto all = seen_in(room);
  for (std::size_t i = at(50.0); i < at(95.0); ++i)
    for (HalfExposure& half : all[i].frame.half) {
      half.begin += std::chrono::milliseconds(i % 2 == 0 ? 4 : -4);
      half.end += std::chrono::milliseconds(i % 2 == 0 ? 4 : -4);
    }
  const auto reports = reports_of(all);
  ASSERT_EQ(reports[at(49.0)].state, EstimateState::good);
  EXPECT_EQ(reports[at(90.0)].reason, EstimateReason::view_differs);
  EXPECT_TRUE(std::none_of(reports.begin() + static_cast<long>(at(50.0)), reports.end(),
                           [](const Report& one) { return one.state == EstimateState::starting; }));
  EXPECT_EQ(reports.back().state, EstimateState::good);
  EXPECT_NEAR(off_deg(room, reports, 119.0), off_deg(room, reports, 49.0), 0.5);
}

/// From 70 s on the walls show little of what they showed. A map is begun anew, where the gyro has the rig.
TEST(Odometer, SaysInANewMapHowWellTheGyroHasCarriedTheHeadingThere) {
  const Room room = turning_room(170.0);
  auto all = seen_in(room);
  change_walls(room, 70.0, 0.8F, all);
  const auto reports = reports_of(all);
  ASSERT_EQ(reports[at(69.0)].state, EstimateState::good);
  EXPECT_LT(reports[at(69.0)].heading_sigma_deg, 0.7);
  EXPECT_EQ(reports[at(137.0)].state, EstimateState::starting);
  ASSERT_EQ(reports.back().state, EstimateState::good);
  EXPECT_NEAR(off_deg(room, reports, 169.0), off_deg(room, reports, 69.0),
              2.0 * reports.back().heading_sigma_deg);
  EXPECT_GT(reports.back().heading_sigma_deg, 1.0);
  EXPECT_LT(reports.back().heading_sigma_deg, 3.0);
}

/// The gyro's bias is another from then on, too. Past images that say nothing the gyro alone carries the
/// heading; what it was before them counts, with the bias that is learnt behind them.
TEST(Odometer, BeginsANewMapWhereTheGyroHasTheRigWithTheBiasThatItLearnsThere) {
  const Room room = turning_room(170.0);
  auto all = seen_in(room);
  change_walls(room, 70.0, 0.8F, all);
  for (std::size_t i = at(70.0); i < all.size(); ++i)
    for (TimedGyro& sample : all[i].gyro) sample.rate_dps += 1.0F;
  const auto reports = reports_of(all);
  ASSERT_EQ(reports[at(69.0)].state, EstimateState::good);
  ASSERT_EQ(reports.back().state, EstimateState::good);
  EXPECT_NEAR(reports.back().bias_dps, room.bias_dps + 1.0, 0.1);
  EXPECT_NEAR(off_deg(room, reports, 169.0), off_deg(room, reports, 69.0),
              2.5 * reports.back().heading_sigma_deg);
  EXPECT_LT(reports.back().heading_sigma_deg, 5.0);
}

/// After five whole turns.
TEST(Odometer, AnOpenMapsAnglesCountFromWhereItBegins) {
  Room room = turning_room(200.0);
  room.angle_deg = [swing = to_and_fro(60.0, 60.0)](double time_s) {
    return 25.0 * std::min(time_s, 75.0) + swing(time_s);
  };
  auto all = seen_in(room);
  change_walls(room, 80.0, 1.0F, all);
  const auto reports = reports_of(all);
  ASSERT_EQ(reports[at(74.0)].state, EstimateState::good);
  ASSERT_EQ(reports.back().state, EstimateState::good);
  EXPECT_GT(reports.back().heading_deg, 1700.0);
  EXPECT_LT(reports.back().heading_sigma_deg, 10.0);
}

/// To and fro before half of the walls, through a lens that is wider than its data sheet says.
Room half_seen_room(double duration_s = 70.0) {
  Room room = turning_room(duration_s);
  room.angle_deg = to_and_fro(90.0, 60.0);
  room.wider = 0.03;
  return room;
}

/// How far off it turned since a time, at most, in sigmas of then and now.
double worst_sigmas_since(double since_s, const Room& room, const std::vector<Report>& reports) {
  double worst = 0.0;
  for (double time_s = since_s; time_s < room.duration_s; time_s += 0.5) {
    const double off = off_deg(room, reports, time_s) - off_deg(room, reports, since_s);
    const double sigma_deg =
        std::hypot(reports[at(time_s)].heading_sigma_deg, reports[at(since_s)].heading_sigma_deg);
    worst = std::max(worst, std::abs(off) / sigma_deg);
  }
  return worst;
}

/// Data sheets promise 3 % for both.
TEST(Odometer, MeetsLensAndGyroHalfWayWhereTheMapDoesNotClose) {
  const Room room = half_seen_room();
  const auto reports = reports_of(seen_in(room));
  ASSERT_EQ(reports.back().state, EstimateState::good);
  EXPECT_NEAR(reports.back().scale, 0.5 * (1.0 + (1.0 + room.wider) * room.scale), 0.005);
  EXPECT_LT(worst_sigmas_since(50.0, room, reports), 2.0);
  for (double time_s = 50.0; time_s < 70.0; time_s += 0.5) {
    const Report& report = reports[at(time_s)];
    EXPECT_GE(report.rate_sigma_dps, 0.02 * std::abs(report.rate_dps));
  }
}

GyroProfile measured_gyro(const Room& room) {
  GyroProfile gyro = data_sheet_gyro();
  gyro.scale = room.scale;
  gyro.scale_uncertainty = 0.002;
  return gyro;
}

TEST(Odometer, BelievesAGyroThatWasMeasuredWhereTheMapDoesNotClose) {
  const Room room = half_seen_room();
  const auto reports = reports_of(seen_in(room), measured_gyro(room));
  ASSERT_EQ(reports.back().state, EstimateState::good);
  EXPECT_NEAR(reports.back().scale, room.scale, 0.003);
  EXPECT_LT(worst_sigmas_since(50.0, room, reports), 2.0);
  for (double time_s = 50.0; time_s < 70.0; time_s += 0.5) {
    const Report& report = reports[at(time_s)];
    EXPECT_LT(report.rate_sigma_dps, 0.3 + 0.005 * std::abs(report.rate_dps));
  }
}

TEST(Odometer, BeginsANewMapWhereItSaidThatAnOpenOneHadTheRig) {
  const Room room = half_seen_room(200.0);
  auto all = seen_in(room);
  change_walls(room, 73.0, 1.0F, all);
  const auto reports = reports_of(all, measured_gyro(room));
  ASSERT_EQ(reports[at(69.0)].state, EstimateState::good);
  ASSERT_EQ(reports[at(140.0)].state, EstimateState::starting);
  ASSERT_EQ(reports.back().state, EstimateState::good);
  EXPECT_NEAR(off_deg(room, reports, 199.0), off_deg(room, reports, 69.0), 1.0);
}

/// In another room, which may fit for a moment, until it begins a new map.
TEST(Odometer, IsNoSurerThanItsGyroWhereHalvesThatDoNotFitDragTheHeading) {
  const Room room = half_seen_room(128.0);
  auto all = seen_in(room);
  change_walls(room, 70.0, 1.0F, all);
  const auto reports = reports_of(all, measured_gyro(room));
  double worst_deg = 0.0;
  for (double time_s = 75.0; time_s < 128.0; time_s += 0.5) {
    const double off = std::abs(off_deg(room, reports, time_s) - off_deg(room, reports, 69.0));
    const Report& report = reports[at(time_s)];
    worst_deg = std::max(worst_deg, off);
    EXPECT_TRUE(report.state == EstimateState::not_trusted || report.state == EstimateState::relocalising)
        << time_s;
    EXPECT_LT(off, 2.0 * report.heading_sigma_deg) << time_s;
  }
  EXPECT_GT(worst_deg, 3.0);
}

/// A covered lens shows nothing; here all halves show something, and nothing that the map has.
TEST(Odometer, BeginsANewMapWhereItIsCarriedIntoAnotherRoom) {
  const Room room = turning_room(180.0);
  auto all = seen_in(room);
  change_walls(room, 70.0, 1.0F, all);
  const auto reports = reports_of(all);
  ASSERT_EQ(reports[at(69.0)].state, EstimateState::good);
  EXPECT_EQ(reports[at(75.0)].reason, EstimateReason::view_differs);
  EXPECT_EQ(reports[at(145.0)].state, EstimateState::starting);
  EXPECT_EQ(reports.back().state, EstimateState::good);
  EXPECT_NEAR(off_deg(room, reports, 179.0), off_deg(room, reports, 69.0),
              2.0 * reports.back().heading_sigma_deg);
  EXPECT_LT(reports.back().heading_sigma_deg, 3.0);
}

TEST(Odometer, FollowsAStepOfTheBias) {
  const Room room = turning_room(90.0);
  auto all = seen_in(room);
  for (Seen& seen : all)
    for (TimedGyro& sample : seen.gyro)
      if (sample.stamp.time > at_s(45.0)) sample.rate_dps += 1.0F;
  const auto reports = reports_of(all);
  EXPECT_NEAR(reports.back().bias_dps, room.bias_dps + 1.0, 0.15);
  double worst_deg = 0.0;
  for (double time_s = 46.0; time_s < 89.0; time_s += 0.25)
    worst_deg = std::max(worst_deg, std::abs(off_deg(room, reports, time_s) - off_deg(room, reports, 44.0)));
  EXPECT_LT(worst_deg, 1.8);  // 2.8 with what is known of a steady bias
}

/// With the first sample that is zero, and not only when that has lasted: no image comes meanwhile.
TEST(Odometer, KnowsThatAGyroThatSetsItselfToZeroHasNoBias) {
  Room room = turning_room(50.0);
  room.bias_dps = 9.0;
  const double stops_s = 45.0;
  room.angle_deg = [turns = room.angle_deg, stops_s](double time_s) {
    return turns(std::min(time_s, stops_s));
  };
  auto all = seen_in(room);
  for (Seen& seen : all) {
    for (TimedGyro& sample : seen.gyro) {
      if (sample.stamp.time < at_s(stops_s)) continue;
      sample.rate_dps = 0.0F;
      sample.reading.rate_dps = {};
    }
    if (seen.frame.exposure_end > at_s(stops_s)) seen.frame.fresh_even = seen.frame.fresh_odd = 0;
  }
  const auto reports = reports_of(all);
  ASSERT_EQ(reports[at(44.0)].state, EstimateState::good);
  EXPECT_NEAR(off_deg(room, reports, 45.75), off_deg(room, reports, 44.0), 0.5);
}

TEST(Odometer, IsLessSureOfTheHeadingWhereGearsShakeTheGyro) {
  auto all = seen_in(turning_room(40.0));
  const Report still = reports_of(all).back();
  std::mt19937 random(5);
  std::normal_distribution<float> shake_dps(0.0F, 3.0F);
  for (Seen& seen : all)
    for (TimedGyro& sample : seen.gyro)
      sample.reading.rate_dps = {shake_dps(random), shake_dps(random), sample.rate_dps};
  const Report shaken = reports_of(all).back();
  ASSERT_EQ(shaken.state, EstimateState::good);
  EXPECT_GT(shaken.heading_sigma_deg, 1.2 * still.heading_sigma_deg);
}

TEST(Odometer, IsDeterministicAndAllocatesNothing) {
  const auto all = seen_in(turning_room(50.0));
  const auto first = reports_of(all);
  Odometer odometer(data_sheet_gyro(), CameraProfile());
  const std::size_t before = allocations();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Report report = odometer.add(all[i].frame, all[i].gyro);
    if (std::isfinite(report.heading_deg)) {
      ASSERT_EQ(report.heading_deg, first[i].heading_deg) << i;
    }
  }
  EXPECT_EQ(allocations(), before);
}

}  // namespace
}  // namespace thermorig::odometer
