// SPDX-License-Identifier: MIT
// What the knobs of camera and scene do to frames. Most look at a hot post in an even room.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "frame_statistics.h"
#include "simulation/moving_things.h"
#include "simulation/scene_shapes.h"
#include "still_camera.h"

namespace thermorig::simulation {
namespace {

constexpr double pitch_deg = 55.0 / 32.0;
constexpr double row_pitch_deg = 35.0 / 24.0;
constexpr double period_s = 0.125 / 0.98;

Panorama room_with(const Patch& hot) {
  Panorama room;
  std::fill(room.temp_c.begin(), room.temp_c.end(), 20.0F);
  fill_patch(room, hot, 120.0);
  return room;
}

/// Without edges, so that every second column tells its middle.
Panorama room_with_post(double azimuth_deg) {
  Panorama room;
  std::fill(room.temp_c.begin(), room.temp_c.end(), 20.0F);
  add_spot(room, {azimuth_deg, 5.0, -450.0, 450.0}, 100.0);
  return room;
}

double weight(const ThermalFrame& frame, std::size_t row, std::size_t column) {
  return std::max(0.0, static_cast<double>(frame.temp_c[row * frame_columns + column]) - 28.0);
}

/// Column of the post, of one chess half or (2) of both.
double post_column(const ThermalFrame& frame, std::size_t row, unsigned parity = 2) {
  double sum = 0.0, columns = 0.0;
  for (std::size_t column = 0; column < frame_columns; ++column) {
    if (parity < 2 && subpage_of(row, column) != parity) continue;
    sum += weight(frame, row, column);
    columns += static_cast<double>(column) * weight(frame, row, column);
  }
  return columns / sum;
}

double bar_row(const ThermalFrame& frame, std::size_t column) {
  double sum = 0.0, rows = 0.0;
  for (std::size_t row = 0; row < frame_rows; ++row) {
    sum += weight(frame, row, column);
    rows += static_cast<double>(row) * weight(frame, row, column);
  }
  return rows / sum;
}

CameraConfig natural(const CameraWorld& world, const SceneWorld& scene = {}) {
  return {.mirrored = false, .world = world, .scene = scene};
}

ThermalFrame post_at(double azimuth_deg, const CameraWorld& world, const SceneWorld& scene = {}) {
  return still_frames(natural(world, scene), room_with_post(azimuth_deg), 1, 0.0, 3).back().frame;
}

TEST(CameraWorld, WidensItsFieldOfViewByItsPitchError) {
  EXPECT_NEAR(post_column(post_at(20.0, {}), 12), 15.5 + 20.0 / pitch_deg, 0.1);
  EXPECT_NEAR(post_column(post_at(20.0, {.pitch_error = 0.03}), 12), 15.5 + 20.0 / pitch_deg / 1.03, 0.1);
  EXPECT_NEAR(post_column(post_at(20.0, {.pitch_error = -0.03}), 12), 15.5 + 20.0 / pitch_deg / 0.97, 0.1);
}

TEST(CameraWorld, DistortsMostInTheCorners) {
  const ThermalFrame straight = post_at(20.0, {});
  const ThermalFrame distorted = post_at(20.0, {.distortion = 0.05});
  const auto shift = [&](std::size_t row) {
    return post_column(distorted, row) - post_column(straight, row);
  };
  EXPECT_NEAR(shift(12), -0.15, 0.08);
  EXPECT_NEAR(shift(0), -0.42, 0.1);
  EXPECT_NEAR(shift(23), -0.42, 0.1);
}

TEST(CameraWorld, TurnsThePictureByItsRoll) {
  const ThermalFrame frame = post_at(0.0, {.roll_deg = 5.0});
  EXPECT_NEAR(post_column(frame, 0) - post_column(frame, 23), 2.0 * 16.77 * std::tan(M_PI / 36.0) / pitch_deg,
              0.15);
  const ThermalFrame level = post_at(0.0, {});
  EXPECT_NEAR(post_column(level, 0) - post_column(level, 23), 0.0, 0.1);
}

TEST(CameraWorld, LooksUpByItsTilt) {
  const Panorama room = room_with({180.0, 360.0, -2.0, 2.0});
  const auto row = [&](double tilt_deg) {
    return bar_row(still_frames(natural({.tilt_deg = tilt_deg}), room, 1, 0.0, 3).back().frame, 16);
  };
  EXPECT_NEAR(row(5.0) - row(0.0), 5.0 / row_pitch_deg, 0.15);
  EXPECT_NEAR(row(-5.0) - row(0.0), -5.0 / row_pitch_deg, 0.15);
}

TEST(CameraWorld, SeesNearThingsFurtherOutFromBeforeItsAxis) {
  const auto shift_deg = [](double arm_m, double distance_m) {
    const ThermalFrame frame = post_at(20.0, {.lever_arm_m = arm_m}, {.distance_m = distance_m});
    return pitch_deg * (post_column(frame, 12) - post_column(post_at(20.0, {}), 12));
  };
  EXPECT_NEAR(shift_deg(0.05, 0.7), 0.98, 0.15);
  EXPECT_NEAR(shift_deg(-0.05, 0.7), -0.91, 0.15);
  EXPECT_NEAR(shift_deg(0.05, 20.0), 0.03, 0.08);
}

unsigned fresh_half(const ThermalFrame& before, const ThermalFrame& after) {
  int even = 0;
  for (std::size_t i = 0; i < frame_pixels; ++i)
    even +=
        before.temp_c[i] != after.temp_c[i] && subpage_of(i / frame_columns, i % frame_columns) == 0 ? 1 : 0;
  return even > 200 ? 0 : 1;
}

/// The frames of a camera that turns past the post, about when it is in the middle.
struct Passing {
  SimulatedFrame frame;
  unsigned fresh;
  double post_deg;  // where the post is
};

constexpr double passing_dps = 20.0;

Passing passing_post(const CameraWorld& world) {
  const auto frames = turning_frames(natural(world), room_with_post(40.0), 1, passing_dps, 18);
  return {frames[15], fresh_half(frames[14].frame, frames[15].frame), 40.0};
}

/// Where the fresh half shows the post, if the truth about its exposure holds.
double shown_post_deg(const Passing& passing, std::size_t row) {
  const double middle_s = 1e-9 * static_cast<double>(passing.frame.exposure_end.time_ns) - period_s / 2.0;
  return passing_dps * middle_s + pitch_deg * (post_column(passing.frame.frame, row, passing.fresh) - 15.5);
}

class TrueExposure : public testing::TestWithParam<const char*> {};

TEST_P(TrueExposure, IsWhatTheMiddleRowsShow) {
  const Passing passing = passing_post(world_named(GetParam(), 1).camera);
  const double middle_deg = (shown_post_deg(passing, 11) + shown_post_deg(passing, 12)) / 2.0;
  EXPECT_NEAR(middle_deg, passing.post_deg, 0.15);
}

INSTANTIATE_TEST_SUITE_P(Worlds, TrueExposure,
                         testing::Values("honest", "honest,camera.membrane_lag_ms=4",
                                         "honest,camera.membrane_lag_ms=40", "honest,camera.rolling_rows=1",
                                         "honest,camera.rolling_rows=-0.5"));

/// How much later than the first row the last one is integrated: the line through all.
double rolling_s(const CameraWorld& world) {
  const Passing passing = passing_post(world);
  double products = 0.0, squares = 0.0;
  for (std::size_t row = 0; row < frame_rows; ++row) {
    const double from_middle = static_cast<double>(row) - 11.5;
    products += from_middle * shown_post_deg(passing, row);
    squares += from_middle * from_middle;
  }
  return -23.0 * products / squares / passing_dps;  // a row that is later shows it too early
}

TEST(CameraWorld, ReadsItsRowsOneAfterTheOtherBothWays) {
  const double at_once_s = rolling_s({});  // what the camera's dead pixels do to the line
  EXPECT_NEAR(at_once_s, 0.0, 0.012);
  EXPECT_NEAR(rolling_s({.rolling_rows = 0.5}) - at_once_s, 0.5 * 0.125, 0.005);
  EXPECT_NEAR(rolling_s({.rolling_rows = -0.5}) - at_once_s, -0.5 * 0.125, 0.005);
}

TEST(CameraWorld, ShowsWhatWasTheLagOfItsMembranesAgo) {
  const auto end_ns = [](double lag_ms) {
    return still_frames(natural({.membrane_lag_ms = lag_ms}), room_with_post(0.0), 1, 0.0, 2)
        .back()
        .exposure_end.time_ns;
  };
  EXPECT_NEAR(1e-6 * static_cast<double>(end_ns(4.0) - end_ns(40.0)), 36.0, 1e-3);
}

TEST(CameraWorld, SendsLaterByItsExtraLatency) {
  const auto latency_ms = [](double extra_ms) {
    const auto frames = still_frames(natural({.extra_latency_ms = extra_ms}), room_with_post(0.0), 1, 0.0, 2);
    return 1e-6 * static_cast<double>(frames.back().ready_ns - frames.back().exposure_end.time_ns);
  };
  EXPECT_NEAR(latency_ms(30.0) - latency_ms(0.0), 30.0, 1e-3);
}

TEST(CameraWorld, LosesSubpagesAndTheFramesThatTheyComplete) {
  const auto frames = still_frames(natural({.lost_subpages = 0.33}), make_panorama("dining", 1), 1, 0.0, 200);
  const double seconds = 1e-9 * static_cast<double>(frames.back().ready_ns - frames.front().ready_ns);
  EXPECT_NEAR(199.0 / (seconds / period_s), 0.67, 0.07);
  int same_half_again = 0;
  for (std::size_t i = 2; i < frames.size(); ++i) {
    const bool same = fresh_half(frames[i - 1].frame, frames[i].frame) ==
                      fresh_half(frames[i - 2].frame, frames[i - 1].frame);
    same_half_again += same ? 1 : 0;
    const double exposed_s =
        1e-9 * static_cast<double>(frames[i].exposure_end.time_ns - frames[i].exposure_begin.time_ns);
    EXPECT_EQ(exposed_s > 2.5 * period_s, same || exposed_s > 3.5 * period_s) << i;
  }
  EXPECT_GT(same_half_again, 30);
}

TEST(CameraWorld, RepeatsFramesWithTheirExposure) {
  const auto frames =
      still_frames(natural({.repeated_frames = 0.05}), make_panorama("dining", 1), 1, 0.0, 600);
  int repeated = 0;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const bool is_same = frames[i].frame.temp_c == frames[i - 1].frame.temp_c;
    repeated += is_same ? 1 : 0;
    EXPECT_EQ(is_same, frames[i].exposure_end.time_ns == frames[i - 1].exposure_end.time_ns);
    EXPECT_GT(frames[i].ready_ns, frames[i - 1].ready_ns);
  }
  EXPECT_NEAR(repeated, 30, 15);
}

TEST(CameraWorld, DriftsWhileItWarmsUp) {
  const auto reading_k = [](double warm_up_k, double time_s) {
    PixelNoise noise(NoiseLevel::of(55.0, 8.0), true, 1, {.warm_up_k = warm_up_k});
    PixelColumns seen;
    seen.fill(20.0F);
    ThermalFrame frame;
    noise.read_half(seen, 0, time_s, frame);
    return std::pair{frame.temp_c[0], noise.sensor_temp_c(time_s)};
  };
  EXPECT_NEAR(reading_k(2.0, 0.0).first - reading_k(0.0, 0.0).first, 2.0, 1e-3);
  EXPECT_NEAR(reading_k(2.0, 120.0).first - reading_k(0.0, 120.0).first, 2.0 * std::exp(-1.0), 1e-3);
  EXPECT_LT(reading_k(2.0, 0.0).second, reading_k(0.0, 0.0).second - 5.0F);
}

TEST(CameraWorld, HasMoreDeadPixels) {
  const auto dead = [](double more) {
    const auto frames =
        still_frames(natural({.dead_pixels = more}), make_panorama("laboratory", 1), 1, 0.0, 4);
    int count = 0;
    for (std::size_t i = 0; i < frame_pixels; ++i)
      count += frames[0].frame.temp_c[i] == frames[3].frame.temp_c[i] ? 1 : 0;
    return count;
  };
  EXPECT_EQ(dead(4.0) - dead(0.0), 4);
}

double deviation_k(const SceneWorld& scene) {
  const auto frame = still_frames(natural({}, scene), make_panorama("garden", 3), 1, 0.0, 3).back().frame;
  return deviation_of({frame.temp_c.begin(), frame.temp_c.end()});
}

TEST(SceneWorld, HasLessContrast) {
  EXPECT_LT(deviation_k({.contrast = 0.25}), 0.5 * deviation_k({}));
  EXPECT_GT(deviation_k({.contrast = 1.2}), 1.05 * deviation_k({}));
}

TEST(SceneWorld, IsCutOffWhereThePixelsAreSaturated) {
  const auto hottest_c = [](double saturation_c) {
    const ThermalFrame frame = post_at(0.0, {}, {.saturation_c = saturation_c});
    double most_c = 0.0;
    for (std::size_t row = 0; row < frame_rows; ++row)
      most_c = std::max<double>(most_c, frame.temp_c[row * frame_columns + 16]);
    return most_c;
  };
  EXPECT_GT(hottest_c(300.0), 80.0);
  EXPECT_LT(hottest_c(60.0), 64.0);
}

/// Middle of what differs from 20 degC at an elevation; none: NaN.
double azimuth_of(const MovingThings& things, double elevation_deg) {
  double sum = 0.0, x = 0.0, y = 0.0;
  for (double azimuth_deg = 0.0; azimuth_deg < 360.0; azimuth_deg += 0.25) {
    const double more_k = things.seen_c(azimuth_deg, elevation_deg, 20.0F) - 20.0;
    sum += more_k;
    x += more_k * std::cos(azimuth_deg * M_PI / 180.0);
    y += more_k * std::sin(azimuth_deg * M_PI / 180.0);
  }
  return sum > 0.0 ? std::atan2(y, x) * 180.0 / M_PI : NAN;
}

/// Speeds in each fifth of a second of a minute.
std::vector<double> speeds_dps(const SceneWorld& scene, double elevation_deg) {
  MovingThings things(scene, 1);
  std::vector<double> speeds;
  double before_deg = NAN;
  for (double time_s = 0.0; time_s < 60.0; time_s += 0.2) {
    things.move_to(time_s);
    const double now_deg = azimuth_of(things, elevation_deg);
    if (time_s > 0.0) speeds.push_back(std::remainder(now_deg - before_deg, 360.0) / 0.2);
    before_deg = now_deg;
  }
  return speeds;
}

TEST(SceneWorld, HasAPersonWhoWalksToAndFro) {
  const auto speeds = speeds_dps({.person_dps = 40.0}, 0.0);
  EXPECT_NEAR(quantile_of(speeds, 0.9), 40.0, 1.0);
  EXPECT_NEAR(quantile_of(speeds, 0.1), -40.0, 1.0);
}

TEST(SceneWorld, HasAPetOnTheFloor) {
  const auto speeds = speeds_dps({.pet_dps = 60.0}, -12.0);
  EXPECT_NEAR(quantile_of(speeds, 0.8), 60.0, 1.0);
  EXPECT_NEAR(quantile_of(speeds, 0.2), -60.0, 1.0);
  MovingThings things({.pet_dps = 60.0}, 1);
  things.move_to(1.0);
  EXPECT_TRUE(std::isnan(azimuth_of(things, 0.0)));
}

TEST(SceneWorld, HasASunThatWandersAndHidesBehindClouds) {
  MovingThings things({.sun_k = 15.0}, 1);
  things.move_to(0.0);
  const double begin_deg = azimuth_of(things, -4.0);
  std::vector<double> warmer_k;
  for (double time_s = 0.0; time_s < 90.0; time_s += 1.0) {
    things.move_to(time_s);
    warmer_k.push_back(things.seen_c(azimuth_of(things, -4.0), -4.0, 20.0F) - 20.0);
  }
  EXPECT_NEAR(quantile_of(warmer_k, 1.0), 15.0, 0.2);
  EXPECT_LT(quantile_of(warmer_k, 0.0), 0.2);
  things.move_to(900.0);
  EXPECT_NEAR(std::remainder(azimuth_of(things, -4.0) - begin_deg, 360.0), 900.0 * 15.0 / 3600.0, 0.1);
}

TEST(SceneWorld, ShowsWhatMovesInTheFramesOfACameraAtRest) {
  const SceneWorld scene{.person_dps = 10.0};
  MovingThings things(scene, 1);
  things.move_to(2.0);
  const double person_deg = azimuth_of(things, 0.0);
  const auto largest_change_k = [&](const SceneWorld& seen) {
    Panorama room;
    std::fill(room.temp_c.begin(), room.temp_c.end(), 20.0F);
    const auto frames = still_frames(natural({}, seen), room, 1, person_deg, 60);
    std::vector<double> changes;
    for (std::size_t i = 0; i < frame_pixels; ++i)
      changes.push_back(std::abs(frames.back().frame.temp_c[i] - frames[8].frame.temp_c[i]));
    return quantile_of(changes, 0.9);
  };
  EXPECT_LT(largest_change_k({}), 3.0);
  EXPECT_GT(largest_change_k(scene), 7.0);
}

}  // namespace
}  // namespace thermorig::simulation
