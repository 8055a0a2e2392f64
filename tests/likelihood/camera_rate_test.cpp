// SPDX-License-Identifier: MIT
#include "thermorig/estimators/likelihood/camera_rate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "../network/allocations.h"
#include "../odometer/room.h"

namespace thermorig::likelihood {
namespace {

using odometer::Room;
using odometer::Seen;

std::vector<Seen> turning(double rate_dps, double duration_s = 5.0, double contrast_k = 0.8) {
  Room room;
  room.duration_s = duration_s;
  room.angle_deg = [rate_dps](double time_s) { return rate_dps * time_s; };
  room.contrast_k = contrast_k;
  return seen_in(room);
}

std::vector<CameraRateReport> reports_of(const std::vector<Seen>& all, int frames = 3,
                                         const CameraProfile& camera = {}) {
  CameraRate rate(camera, frames);
  std::vector<CameraRateReport> reports;
  for (const Seen& seen : all) reports.push_back(rate.add(seen.frame));
  return reports;
}

TEST(TheCamerasRate, IsThatOfTheShaftWithinItsSigma) {
  for (const double rate_dps : {0.0, 20.0, -75.0, 140.0, -205.0}) {
    double covered = 0.0, count = 0.0;
    for (const CameraRateReport& report : reports_of(turning(rate_dps))) {
      if (!report.is_complete) continue;
      EXPECT_TRUE(report.is_told);
      EXPECT_NEAR(report.rate_dps, rate_dps, 5.0 * report.sigma_dps);
      EXPECT_LT(report.sigma_dps, 1.0 + 0.07 * std::abs(rate_dps));
      covered += std::abs(report.rate_dps - rate_dps) <= 2.0 * report.sigma_dps ? 1.0 : 0.0;
      count += 1.0;
    }
    EXPECT_GT(count, 30.0);
    EXPECT_GE(covered, 0.85 * count) << rate_dps;
  }
}

TEST(TheCamerasRate, NeedsAsManyFramesAsItsWindowHas) {
  for (const int frames : {1, 2, 3}) {
    const auto reports = reports_of(turning(50.0, 2.0), frames);
    for (int i = 0; i < 5; ++i)
      EXPECT_EQ(reports[static_cast<std::size_t>(i)].is_complete, i >= frames) << frames << " " << i;
    EXPECT_NEAR(reports.back().window_s, 0.125 * (frames + 1), 1e-6);
  }
}

TEST(TheCamerasRate, OfLongerWindowsIsKnownBetter) {
  const auto seen = turning(60.0);
  double before_dps = std::numeric_limits<double>::infinity();
  for (const int frames : {1, 2, 3}) {
    const auto reports = reports_of(seen, frames);
    double sum = 0.0;
    for (std::size_t i = 10; i < 30; ++i) sum += reports[i].sigma_dps;
    EXPECT_LT(sum, before_dps);
    before_dps = sum;
  }
}

TEST(TheCamerasRate, HasTheOtherSignWhereTheImageIsNoMirrorImage) {
  const auto seen = turning(80.0);
  CameraProfile camera;
  const double mirrored_dps = reports_of(seen, 3, camera).back().rate_dps;
  camera.mirrored = false;
  EXPECT_NEAR(reports_of(seen, 3, camera).back().rate_dps, -mirrored_dps, 1e-9);
}

TEST(TheCamerasRate, GoesByTheTimesOfFramesNotByTheRateThatWasSet) {
  auto seen = turning(60.0, 8.0);
  const auto as_set = reports_of(seen);
  constexpr double slower = 1.03;  // frames follow each other so much later; exposures stay as they are
  const HostTime begin = seen.front().frame.exposure_begin;
  for (Seen& one : seen) {
    TimedFrame& frame = one.frame;
    const HostDuration later = from_s((slower - 1.0) * to_s(frame.exposure_begin - begin));
    for (HostTime* time :
         {&frame.stamp.time, &frame.exposure_begin, &frame.exposure_end, &frame.half[0].begin,
          &frame.half[0].end, &frame.half[1].begin, &frame.half[1].end})
      *time += later;
  }
  const auto reports = reports_of(seen);
  for (std::size_t i = 10; i < reports.size(); ++i)
    EXPECT_NEAR(reports[i].rate_dps, as_set[i].rate_dps / slower, 1e-3 * as_set[i].rate_dps) << i;
}

TEST(TheCamerasRate, OfAWallIsNotTold) {
  int told = 0, count = 0;
  for (const CameraRateReport& report : reports_of(turning(90.0, 6.0, 0.0))) {
    if (!report.is_complete) continue;
    ++count;
    told += report.is_told ? 1 : 0;
  }
  EXPECT_LE(told, count / 5);
}

TEST(TheCamerasRate, HoldsItsSigmaWhereNextToNothingIsSeen) {
  for (const double rate_dps : {60.0, 120.0}) {
    double covered = 0.0, silent = 0.0, count = 0.0;
    for (const CameraRateReport& report : reports_of(turning(rate_dps, 10.0, 0.1))) {
      if (!report.is_complete) continue;
      const double error_dps = std::abs(report.rate_dps - rate_dps);
      covered += error_dps <= 2.0 * report.sigma_dps ? 1.0 : 0.0;
      silent += report.is_told && error_dps > told_sigma_dps ? 1.0 : 0.0;
      count += 1.0;
    }
    EXPECT_GE(covered, 0.9 * count) << rate_dps;
    EXPECT_LE(silent, 0.03 * count) << rate_dps;
  }
}

/// Windows against the shaft, those that lie within one stretch of `stretch_s`.
struct Agreement {
  double covered = 0.0, silent = 0.0, count = 0.0;
};

Agreement agreement_with(const std::function<double(double)>& angle_deg, double contrast_k,
                         double stretch_s) {
  Room room;
  room.angle_deg = angle_deg;
  room.contrast_k = contrast_k;
  const std::vector<Seen> all = seen_in(room);
  const std::vector<CameraRateReport> reports = reports_of(all);
  Agreement agreement;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!reports[i].is_complete) continue;
    const double end_s = to_s(all[i].frame.exposure_end.time_since_epoch());
    const double begin_s = end_s - reports[i].window_s;
    if (std::floor(begin_s / stretch_s) != std::floor(end_s / stretch_s)) continue;
    const double rate_dps = (angle_deg(end_s) - angle_deg(begin_s)) / reports[i].window_s;
    const double error_dps = std::abs(reports[i].rate_dps - rate_dps), sigma_dps = reports[i].sigma_dps;
    agreement.covered += error_dps <= 2.0 * sigma_dps ? 1.0 : 0.0;
    agreement.silent +=
        reports[i].is_told && error_dps > std::max(told_sigma_dps, 4.0 * sigma_dps) ? 1.0 : 0.0;
    agreement.count += 1.0;
  }
  return agreement;
}

TEST(TheCamerasRate, IsNotHeldByWindowsBeforeWhereTheShaftReversesAtOnce) {
  constexpr double stretch_s = 2.0;
  const auto reversing_deg = [](double time_s) {  // at 120 deg/s
    const double phase_s = std::fmod(time_s, 2.0 * stretch_s);
    return 120.0 * std::min(phase_s, 2.0 * stretch_s - phase_s);
  };
  for (const double contrast_k : {0.2, 0.4, 0.8}) {
    const Agreement agreement = agreement_with(reversing_deg, contrast_k, stretch_s);
    EXPECT_GT(agreement.count, 300.0);
    EXPECT_GE(agreement.covered, 0.9 * agreement.count) << contrast_k;
    EXPECT_LE(agreement.silent, 0.002 * agreement.count) << contrast_k;
  }
}

TEST(TheCamerasRate, IsNotHeldByWindowsBeforeWhereTheShaftNeverTurnsTheSame) {
  for (const double contrast_k : {0.1, 0.2, 0.4}) {
    const Agreement agreement = agreement_with(odometer::to_and_fro(90.0, 150.0), contrast_k, 1e9);
    EXPECT_GE(agreement.covered, 0.9 * agreement.count) << contrast_k;
    EXPECT_EQ(agreement.silent, 0.0) << contrast_k;
  }
}

TEST(TheCamerasRate, BeyondWhatIsTriedIsNotTold) {
  for (const CameraRateReport& report : reports_of(turning(500.0, 4.0)))
    if (report.is_complete && report.is_told) {
      EXPECT_LT(report.sigma_dps, told_sigma_dps);
      EXPECT_LE(std::abs(report.rate_dps), fastest_dps);
    }
}

TEST(TheCamerasRate, BeginsAnewAfterAFrameThatRepeatsTheOneBefore) {
  auto seen = turning(50.0, 4.0);
  seen[15].frame.stale = true;
  const auto reports = reports_of(seen);
  EXPECT_TRUE(reports[14].is_complete);
  EXPECT_FALSE(reports[15].has_image);
  for (std::size_t i = 15; i < 19; ++i) EXPECT_FALSE(reports[i].is_complete) << i;
  EXPECT_TRUE(reports[19].is_complete);
}

TEST(TheCamerasRate, BeginsAnewWhereAHalfIsMissing) {
  auto seen = turning(50.0, 4.0);
  seen.erase(seen.begin() + 12, seen.begin() + 14);  // parities go on alternating
  const auto reports = reports_of(seen);
  EXPECT_TRUE(reports[11].is_complete);
  EXPECT_FALSE(reports[12].is_complete || reports[14].is_complete);
  EXPECT_NEAR(reports[15].rate_dps, 50.0, 5.0);
}

TEST(TheCamerasRate, DoesNotSufferFromPixelsThatAreBroken) {
  auto seen = turning(40.0);
  for (Seen& one : seen) {
    one.frame.frame.temp_c[5 * frame_columns + 7] = 55.0F;
    one.frame.frame.temp_c[12 * frame_columns + 20] = std::numeric_limits<float>::quiet_NaN();
    one.frame.frame.temp_c[0] = -8.0F;
  }
  for (const CameraRateReport& report : reports_of(seen))
    if (report.is_complete) {
      EXPECT_NEAR(report.rate_dps, 40.0, std::max(2.0, 5.0 * report.sigma_dps));
    }
}

TEST(TheCamerasRate, LearnsWhatItsPixelsAlwaysAdd) {
  auto seen = turning(15.0, 40.0);
  for (Seen& one : seen)
    for (std::size_t i = 0; i < frame_pixels; ++i)
      one.frame.frame.temp_c[i] += static_cast<float>((i * 7919) % 13) * 0.1F;  // up to 1.2 K
  const auto reports = reports_of(seen);
  EXPECT_LT(reports.back().noise_c, reports[20].noise_c);
  EXPECT_NEAR(reports.back().noise_c, 0.5, 0.1);
  EXPECT_NEAR(reports.back().rate_dps, 15.0, 3.0);
}

TEST(TheCamerasRate, SaysNothingOfImagesThatAreNone) {
  auto seen = turning(40.0, 3.0);
  for (Seen& one : seen) one.frame.frame.temp_c.fill(std::numeric_limits<float>::quiet_NaN());
  for (const CameraRateReport& report : reports_of(seen))
    EXPECT_FALSE(report.has_image || report.is_complete);
}

TEST(TheCamerasRate, AsksForNoMemoryFrameByFrame) {
  const auto seen = turning(70.0, 3.0);
  for (const int frames : {1, 2, 3}) {
    CameraRate rate({}, frames);
    const std::size_t before = allocations();
    for (const Seen& one : seen) rate.add(one.frame);
    EXPECT_EQ(allocations(), before);
  }
}

}  // namespace
}  // namespace thermorig::likelihood
