// SPDX-License-Identifier: MIT
#include "thermorig/estimators/window_bounds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "../odometer/room.h"

namespace thermorig::estimators {
namespace {

Measurement measurement_of(const odometer::Seen& seen) {
  Measurement measurement{.frame = seen.frame, .gyro = seen.gyro};
  float sum_dps = 0.0F;
  for (const TimedGyro& sample : seen.gyro) sum_dps += sample.rate_dps;
  measurement.sample.rate_gyro_dps = sum_dps / static_cast<float>(seen.gyro.size());
  return measurement;
}

WindowBounds bounds_in(const odometer::Room& room) {
  WindowBounds bounds{RigProfile{}};
  for (const odometer::Seen& seen : seen_in(room)) {
    const Measurement measurement = measurement_of(seen);
    bounds.take(measurement.frame, bounds.bank().add(measurement));
  }
  return bounds;
}

odometer::Room turning_room(double duration_s) {
  odometer::Room room;
  room.duration_s = duration_s;
  room.angle_deg = odometer::to_and_fro(300.0, 120.0);
  return room;
}

TEST(WindowBounds, AreKnownOfNearlyAllWindowsOnceThereIsAPanorama) {
  const WindowBounds bounds = bounds_in(turning_room(70.0));
  std::vector<float> known = bounds.bounds_dps(3);
  const std::size_t all = known.size();
  for (std::size_t i = 0; i < 3; ++i) EXPECT_TRUE(std::isnan(known[i]));  // no window yet
  std::erase_if(known, [](float bound_dps) { return !std::isfinite(bound_dps); });
  EXPECT_GT(known.size(), all - all / 10);
  const auto middle = known.begin() + static_cast<std::ptrdiff_t>(known.size() / 2);
  std::nth_element(known.begin(), middle, known.end());
  EXPECT_GT(*middle, 0.1F);
  EXPECT_LT(*middle, 5.0F);
}

TEST(WindowBounds, OfLongerWindowsAreLower) {
  const WindowBounds bounds = bounds_in(turning_room(45.0));
  const std::vector<float> of_one = bounds.bounds_dps(1), of_five = bounds.bounds_dps(5);
  std::size_t lower = 0, known = 0;
  for (std::size_t i = 0; i < of_five.size(); ++i) {
    if (!std::isfinite(of_one[i]) || !std::isfinite(of_five[i])) continue;
    ++known;
    lower += of_five[i] < of_one[i] ? 1U : 0U;
  }
  EXPECT_GT(known, 100U);
  EXPECT_GT(lower, known - known / 20);
}

TEST(WindowBounds, AreNotKnownWithoutAPanorama) {
  const WindowBounds bounds = bounds_in(turning_room(5.0));
  const std::vector<float> known = bounds.bounds_dps(3);
  EXPECT_GT(known.size(), 30U);
  for (const float bound_dps : known) EXPECT_TRUE(std::isnan(bound_dps));
}

}  // namespace
}  // namespace thermorig::estimators
