// SPDX-License-Identifier: MIT
#include "thermorig/estimators/odometer/map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "../network/allocations.h"
#include "room.h"
#include "support/at_s.h"
#include "thermorig/estimators/odometer/odometer.h"

namespace thermorig::odometer {
namespace {

using MapPointer = std::shared_ptr<const Map>;

Odometer begun_with(MapPointer map) {
  GyroProfile gyro;
  gyro.bias_uncertainty_dps = 10.0;
  return Odometer(gyro, CameraProfile(), std::move(map));
}

/// A session of before: its map, and by how much its headings are off the shaft's angles.
struct Before {
  MapPointer map;
  double origin_deg = 0.0;
};

const Before& before() {
  static const Before session = [] {
    const Room room = turning_room(60.0);
    Odometer odometer = begun_with(nullptr);
    double heading_deg = 0.0;
    for (const Seen& seen : seen_in(room)) heading_deg = odometer.add(seen.frame, seen.gyro).heading_deg;
    return Before{std::make_shared<const Map>(odometer.map().value()), heading_deg - room.angle_deg(60.0)};
  }();
  return session;
}

/// The same room on another day: the gyro has another bias, and the rig begins elsewhere.
Room another_day() {
  Room room = turning_room(40.0);
  room.noise = 12;
  room.bias_dps = -2.0;
  room.angle_deg = [turning = room.angle_deg](double time_s) { return 130.0 + turning(time_s); };
  return room;
}

struct Answer {
  Report report;
  MapUse use = MapUse::none;
  double off_deg = 0.0;  // against the origin of the map before
};

std::vector<Answer> answers_in(const Room& room, Odometer& odometer) {
  std::vector<Answer> all;
  for (const Seen& seen : seen_in(room)) {
    Answer answer{odometer.add(seen.frame, seen.gyro), odometer.map_use()};
    const double shaft_deg = room.angle_deg(to_s(seen.frame.exposure_end - at_s(0.0)));
    answer.off_deg = std::remainder(answer.report.heading_deg - shaft_deg - before().origin_deg, 360.0);
    all.push_back(answer);
  }
  return all;
}

bool is_tracking(const Answer& answer) {
  return answer.report.state == EstimateState::good;
}

TEST(OdometerMap, ASecondSessionInTheSameRoomStartsWithAnAbsoluteHeading) {
  Odometer odometer = begun_with(before().map);
  const auto all = answers_in(another_day(), odometer);
  const auto first = std::find_if(all.begin(), all.end(), is_tracking);
  ASSERT_NE(first, all.end());
  EXPECT_LT(first - all.begin(), 240) << "frames: 30 s";
  std::for_each(all.begin(), first, [](const Answer& answer) {
    if (answer.report.reason == EstimateReason::none) {
      EXPECT_EQ(answer.report.state, EstimateState::relocalising);
    }
  });
  std::for_each(first, all.end(), [](const Answer& answer) {
    EXPECT_EQ(answer.use, MapUse::found);
    EXPECT_NEAR(answer.off_deg, 0.0, 2.0);
  });
  EXPECT_NEAR(all.back().off_deg, 0.0, 0.7);
}

/// To and fro, 8 s at each speed: so long none of bias, scale and latency can be told from the others.
double angle_of_legs_deg(double time_s) {
  constexpr double leg_s = 8.0;
  const double leg = std::floor(time_s / leg_s), in_leg_s = time_s - leg * leg_s;
  const double rate_dps = 40.0 + 15.0 * std::fmod(std::floor(leg / 2.0), 5.0);
  return std::fmod(leg, 2.0) < 1.0 ? rate_dps * in_leg_s : rate_dps * (leg_s - in_leg_s);
}

/// At 15 deg/s or at rest: the speed never changes by as much as it does on most rigs.
TEST(OdometerMap, IsRecognisedBySweepsThatAreSlowAllAlong) {
  Room room = another_day();
  room.duration_s = 60.0;
  room.angle_deg = [](double time_s) {
    const double in_sweep_s = std::fmod(time_s, 36.0);  // 16 s there, 4 s of rest, 16 s back
    return 15.0 * (in_sweep_s < 16.0 ? in_sweep_s : std::min(16.0, 36.0 - in_sweep_s));
  };
  Odometer odometer = begun_with(before().map);
  const auto all = answers_in(room, odometer);
  EXPECT_EQ(all.back().use, MapUse::found);
  EXPECT_NEAR(all.back().off_deg, 0.0, 2.0);
}

/// At one speed a wrong scale looks like a wrong bias: only another speed tells them apart.
TEST(OdometerMap, IsRecognisedThroughALensThatNobodyMeasured) {
  Room room = turning_room(100.0);
  room.wider = 0.02;
  room.angle_deg = angle_of_legs_deg;
  Odometer first = begun_with(nullptr);
  answers_in(room, first);
  ASSERT_TRUE(first.map());
  room.noise = 12;
  room.bias_dps = -2.0;
  Odometer second = begun_with(std::make_shared<const Map>(first.map().value()));
  const auto all = answers_in(room, second);
  const auto found = std::find_if(all.begin(), all.end(), is_tracking);
  ASSERT_NE(found, all.end());
  EXPECT_LT(found - all.begin(), 160) << "frames: 20 s";
  EXPECT_EQ(found->use, MapUse::found);
}

TEST(OdometerMap, AMapOfAnotherRoomIsNotTrustedAndANewOneIsBegun) {
  Room room = turning_room(120.0);
  room.walls = 8;
  Odometer odometer = begun_with(before().map);
  const auto all = answers_in(room, odometer);
  EXPECT_TRUE(
      std::none_of(all.begin(), all.end(), [](const Answer& answer) { return answer.use == MapUse::found; }));
  EXPECT_EQ(all[240].report.state, EstimateState::relocalising);
  EXPECT_EQ(all.back().use, MapUse::other);
  EXPECT_EQ(all.back().report.state, EstimateState::good) << "in its own map";
}

/// Found in the map of another room the camera seems to turn as it does not.
TEST(OdometerMap, WhileAMapIsOnTrialItTeachesTheRateNothing) {
  constexpr double untold_dps = 5.0;  // bias and scale of the gyro, before images tell them
  Room room = turning_room(60.0);
  room.walls = 10;
  room.angle_deg = angle_of_legs_deg;
  Odometer odometer = begun_with(before().map);
  int on_trial = 0;
  for (const Seen& seen : seen_in(room)) {
    const Report report = odometer.add(seen.frame, seen.gyro);
    if (report.state != EstimateState::relocalising) continue;
    ++on_trial;
    const double begin_s = to_s(seen.frame.exposure_begin - at_s(0.0));
    const double end_s = to_s(seen.frame.exposure_end - at_s(0.0));
    const double shaft_dps = (room.angle_deg(end_s) - room.angle_deg(begin_s)) / (end_s - begin_s);
    EXPECT_NEAR(report.rate_dps, shaft_dps, untold_dps) << "at " << end_s;
    EXPECT_NEAR(report.rate_dps, shaft_dps, 3.0 * report.rate_sigma_dps) << "at " << end_s;
    if (std::isfinite(report.heading_deg)) {
      EXPECT_GT(report.heading_sigma_deg, 100.0) << "at " << end_s;  // of any direction
    }
  }
  EXPECT_GT(on_trial, 240) << "frames: 30 s";
}

/// Faint walls, other ones than the map's: a flat picture fits better there.
TEST(OdometerMap, WhileItIsOnTrialAViewThatDiffersOnlyMeansAnotherPlace) {
  Room room = turning_room(30.0);
  room.walls = 10;
  room.contrast_k = 0.3;
  room.angle_deg = angle_of_legs_deg;
  Odometer odometer = begun_with(before().map);
  for (const Seen& seen : seen_in(room)) {
    const Report report = odometer.add(seen.frame, seen.gyro);
    if (odometer.map_use() != MapUse::searching) break;
    EXPECT_EQ(report.state, EstimateState::relocalising);
  }
}

/// NaN where it knows nothing.
bool are_same(const std::vector<float>& one, const std::vector<float>& other) {
  return std::equal(one.begin(), one.end(), other.begin(), other.end(),
                    [](float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); });
}

TEST(OdometerMap, IsNotWrittenWhileItIsOnTrial) {
  Odometer odometer = begun_with(before().map);
  std::vector<float> first;
  int compared = 0;
  for (const Seen& seen : seen_in(another_day())) {
    odometer.add(seen.frame, seen.gyro);
    const std::vector<float> image_c = odometer.map_image_c();
    if (image_c.empty()) continue;
    if (first.empty()) first = image_c;
    if (odometer.map_use() != MapUse::searching) continue;
    ++compared;
    ASSERT_TRUE(are_same(image_c, first)) << "frame " << compared;
  }
  EXPECT_GT(compared, 40) << "frames: 5 s";
  EXPECT_FALSE(are_same(odometer.map_image_c(), first)) << "once it was found";
}

/// A wrong latency, scale or bias would fit there, and its heading be off as soon as the rig turns back.
TEST(OdometerMap, AtOneSpeedItWaitsForAnother) {
  Room room = another_day();
  room.duration_s = 75.0;
  room.angle_deg = [](double time_s) { return 60.0 * std::min(time_s, 120.0 - time_s); };
  Odometer odometer = begun_with(before().map);
  const auto all = answers_in(room, odometer);
  constexpr std::size_t turns_back = 470;  // frames: 59 s
  EXPECT_EQ(all[turns_back].report.state, EstimateState::relocalising);
  EXPECT_EQ(all[turns_back].use, MapUse::searching) << "nor is it given up";
  EXPECT_EQ(all.back().use, MapUse::found);
  EXPECT_NEAR(all.back().off_deg, 0.0, 2.0);
}

TEST(OdometerMap, AtRestItWaitsForAnotherView) {
  Room room = another_day();
  room.duration_s = 70.0;
  room.angle_deg = [](double) { return 130.0; };
  Odometer odometer = begun_with(before().map);
  EXPECT_EQ(answers_in(room, odometer).back().report.state, EstimateState::relocalising);
  EXPECT_EQ(odometer.map_use(), MapUse::searching);
  EXPECT_FALSE(odometer.map()) << "what is in doubt is not kept";
}

TEST(OdometerMap, ThereIsNoneBeforeItTracks) {
  Odometer odometer = begun_with(nullptr);
  for (const Seen& seen : seen_in(turning_room(15.0))) odometer.add(seen.frame, seen.gyro);
  EXPECT_FALSE(odometer.map());
  EXPECT_EQ(odometer.map_use(), MapUse::none);
}

TEST(OdometerMap, GoesOnBeingTheSameMapFromSessionToSession) {
  Odometer second = begun_with(before().map);
  answers_in(another_day(), second);
  Odometer third = begun_with(std::make_shared<const Map>(second.map().value()));
  EXPECT_NEAR(answers_in(another_day(), third).back().off_deg, 0.0, 1.0);
}

TEST(OdometerMap, BeginningWithItAllocatesNothingAfterwards) {
  const auto all = seen_in(another_day());
  Odometer odometer = begun_with(before().map);
  const std::size_t count = allocations();
  for (const Seen& seen : all) odometer.add(seen.frame, seen.gyro);
  EXPECT_EQ(allocations(), count);
}

}  // namespace
}  // namespace thermorig::odometer
