// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "estimates_of.h"
#include "thermorig/learning/study/evaluation.h"

namespace thermorig::study {
namespace {

AngleTrack track_of(const std::vector<JudgedWindow>& estimates, const network::Acquisition& acquisition,
                    std::size_t points = 300) {
  return evaluate(estimates, std::span(&acquisition, 1), {.angle_points = points}).angles.at(0);
}

std::vector<JudgedWindow> steady(std::uint32_t first, std::uint32_t last, float thermal_error) {
  std::vector<JudgedWindow> estimates;
  for (std::uint32_t i = first; i <= last; ++i) estimates.push_back(judged(i, 60, thermal_error, 0, -1));
  return estimates;
}

TEST(AngleTrack, OfASteadyErrorDriftsByIt) {
  const AngleTrack track = track_of(steady(1, 100, 2.0F), plain_acquisition("a", 101, 60.0F));
  EXPECT_NEAR(track.integrated_s, 10.0, 1e-9);
  EXPECT_NEAR(track.drift_deg_per_min[thermal_name], 120.0, 1e-9);
  EXPECT_NEAR(track.drift_deg_per_min[gyro_name], -60.0, 1e-9);
  EXPECT_NEAR(track.drift_deg_per_min[fusion_name], 0.0, 1e-9);
  EXPECT_NEAR(track.worst_deg[thermal_name], 20.0, 1e-9);
  EXPECT_NEAR(track.worst_deg[gyro_name], 10.0, 1e-9);
  EXPECT_DOUBLE_EQ(track.commanded_deg.back(), 600.0);
}

TEST(AngleTrack, From30SecondsOnForgetsWhatWasBefore) {
  std::vector<JudgedWindow> estimates = steady(1, 299, 50.0F);
  const std::vector<JudgedWindow> later = steady(300, 400, 2.0F);
  estimates.insert(estimates.end(), later.begin(), later.end());
  const AngleTrack track = track_of(estimates, plain_acquisition("a", 401, 60.0F));
  EXPECT_NEAR(track.settled_drift_deg_per_min[thermal_name], 120.0, 1e-6);
  EXPECT_NEAR(track.settled_worst_deg[thermal_name], 20.2, 1e-6);
  EXPECT_GT(track.worst_deg[thermal_name], 1000.0);
  const AngleTrack brief = track_of(steady(1, 100, 2.0F), plain_acquisition("a", 101, 60.0F));
  EXPECT_TRUE(std::isnan(brief.settled_worst_deg[thermal_name]));
}

TEST(AngleTrack, IntegratesNothingWhereNoWindowEnds) {
  std::vector<JudgedWindow> estimates = steady(3, 10, 2.0F);
  const std::vector<JudgedWindow> later = steady(63, 70, 2.0F);
  estimates.insert(estimates.end(), later.begin(), later.end());
  const AngleTrack track = track_of(estimates, plain_acquisition("a", 100, 60.0F));
  EXPECT_NEAR(track.integrated_s, 1.6, 1e-9);
  EXPECT_NEAR(track.worst_deg[thermal_name], 3.2, 1e-9);
}

TEST(AngleTrack, TakesTheTrueTimeBetweenFrames) {
  network::Acquisition acquisition = plain_acquisition("a", 4, 60.0F);
  acquisition.time[3] = acquisition.time[2] + from_s(0.25);
  const AngleTrack track = track_of({judged(3, 60, 4, 0, 0)}, acquisition);
  EXPECT_NEAR(track.integrated_s, 0.25, 1e-9);
  EXPECT_NEAR(track.worst_deg[thermal_name], 1.0, 1e-9);
}

TEST(AngleTrack, LeavesAWindowThatOneEstimatorLacksToTheOthers) {
  std::vector<JudgedWindow> estimates = steady(1, 10, 2.0F);
  for (std::size_t i = 0; i < 5; ++i) estimates[i].rate_dps[gyro_name] = nan;
  const AngleTrack track = track_of(estimates, plain_acquisition("a", 20, 60.0F));
  EXPECT_NEAR(track.integrated_s, 1.0, 1e-9);
  EXPECT_NEAR(track.worst_deg[thermal_name], 2.0, 1e-9);
  EXPECT_NEAR(track.worst_deg[gyro_name], 0.5, 1e-9);
  EXPECT_NEAR(track.drift_deg_per_min[gyro_name], -60.0, 1e-9);  // over its own time, not diluted
  EXPECT_EQ(track.error_deg[gyro_name].at(5), 0.0);
  EXPECT_EQ(track.error_deg[gyro_name].size(), track.time_s.size());
}

TEST(AngleTrack, GoesOnWithoutAnEstimatorThatNeverSaysAnything) {
  std::vector<JudgedWindow> estimates = steady(1, 10, 2.0F);
  for (JudgedWindow& estimate : estimates) estimate.rate_dps[gyro_name] = nan;
  const AngleTrack track = track_of(estimates, plain_acquisition("a", 20, 60.0F));
  EXPECT_NEAR(track.integrated_s, 1.0, 1e-9);
  EXPECT_TRUE(track.error_deg[gyro_name].empty());
  EXPECT_TRUE(std::isnan(track.drift_deg_per_min[gyro_name]));
  EXPECT_TRUE(std::isnan(track.worst_deg[gyro_name]));
}

TEST(AngleTrack, IsThinnedFromTheBeginningToTheEnd) {
  const std::vector<JudgedWindow> estimates = steady(1, 1000, 2.0F);
  const network::Acquisition acquisition = plain_acquisition("a", 1001, 60.0F);
  const AngleTrack few = track_of(estimates, acquisition, 25);
  ASSERT_EQ(few.time_s.size(), 25U);
  EXPECT_DOUBLE_EQ(few.time_s.front(), 0.0);
  EXPECT_DOUBLE_EQ(few.time_s.back(), 100.0);
  EXPECT_DOUBLE_EQ(few.error_deg[thermal_name].back(), 200.0);
  EXPECT_EQ(few.error_deg[gyro_name].size(), 25U);
  const AngleTrack all = track_of(estimates, acquisition, 5000);
  EXPECT_EQ(all.time_s.size(), 1001U);
  EXPECT_EQ(few.drift_deg_per_min[thermal_name], all.drift_deg_per_min[thermal_name]);
}

TEST(AngleTrack, OfNoWindowsIsOnePointAndNoDrift) {
  const AngleTrack track = track_of({}, plain_acquisition("a", 10, 60.0F));
  EXPECT_EQ(track.time_s, std::vector<double>{0.0});
  for (const double drift : track.drift_deg_per_min.values()) EXPECT_TRUE(std::isnan(drift));
}

TEST(AngleTrack, NeedsNoFrameBeforeTheFirst) {
  const AngleTrack track = track_of({judged(0, 60, 2, 0, 0)}, plain_acquisition("a", 10, 60.0F));
  EXPECT_DOUBLE_EQ(track.integrated_s, 0.0);
}

}  // namespace
}  // namespace thermorig::study
