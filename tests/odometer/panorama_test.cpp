// SPDX-License-Identifier: MIT
#include "estimators/odometer/panorama.h"

#include <gtest/gtest.h>

#include <cmath>

namespace thermorig::odometer {
namespace {

constexpr double bin_deg = Panorama::bin_deg;

Panorama::Column column_of(float value) {
  Panorama::Column column;
  column.fill(value);
  return column;
}

/// Both classes of rows show their azimuth, from -90 to 90 deg.
Panorama ramp() {
  Panorama panorama;
  panorama.clear();
  for (const std::size_t row_class : {0U, 1U})
    for (double azimuth_deg = -90.0; azimuth_deg <= 90.0; azimuth_deg += bin_deg) {
      const auto ray = Panorama::of_column(azimuth_deg, 0.0, row_class);
      panorama.seed(ray, {.low = ray.middle - 0.5,
                          .high = ray.middle - 0.5,
                          .temp_c = column_of(static_cast<float>(azimuth_deg)),
                          .slope = column_of(0.0F),
                          .variance = column_of(0.04F)});
    }
  panorama.add_up();
  return panorama;
}

TEST(Panorama, ShowsTheMeanOverWhatAPixelSweeps) {
  const Panorama panorama = ramp();
  for (const double azimuth_deg : {-40.0, 0.0, 0.3, 25.0})  // across the origin too
    for (const double half_width_deg : {0.0, 3.0, 12.0}) {
      Panorama::Predicted predicted;
      panorama.predict(Panorama::of_column(azimuth_deg, half_width_deg, 1), 1, false, predicted);
      EXPECT_EQ(predicted.known[5], 1.0F);
      EXPECT_NEAR(predicted.temp_c[5], azimuth_deg, 0.6) << half_width_deg;
      EXPECT_NEAR(predicted.of_azimuth.slope[5], 1.0, 0.02) << half_width_deg;
    }
}

TEST(Panorama, ShowsAPixelByItselfWhatItShowsItsWholeColumn) {
  const Panorama panorama = ramp();
  for (const double azimuth_deg : {-40.0, 0.3, 88.0, 150.0})  // seen, and not
    for (const bool smooth : {false, true}) {
      const auto ray = Panorama::of_column(azimuth_deg, 3.0, 1);
      Panorama::Predicted column, row;
      panorama.predict(ray, 2, smooth, column);
      for (std::size_t k = 0; k < half_rows; ++k) {
        panorama.predict(Panorama::of_pixel(azimuth_deg, 3.0, 2 * k + 1), 2, smooth, row);
        EXPECT_EQ(row.known[k], column.known[k]) << azimuth_deg;
        EXPECT_NEAR(row.temp_c[k], column.temp_c[k], 1e-4) << azimuth_deg;
        EXPECT_NEAR(row.variance[k], column.variance[k], 1e-6) << azimuth_deg;
        EXPECT_NEAR(row.of_azimuth.slope[k], column.of_azimuth.slope[k], 1e-4) << azimuth_deg;
        EXPECT_NEAR(row.of_azimuth.variance[k], column.of_azimuth.variance[k], 1e-6) << azimuth_deg;
      }
    }
}

TEST(Panorama, IsSurerOfTheMeanOverMoreBins) {
  const Panorama panorama = ramp();
  Panorama::Predicted narrow, wide;
  panorama.predict(Panorama::of_column(10.0, 0.0, 0), 1, false, narrow);
  panorama.predict(Panorama::of_column(10.0, 5.0 * bin_deg, 0), 1, false, wide);
  EXPECT_NEAR(wide.variance[0], 0.04 / 10.0, 1e-3);
  EXPECT_GT(narrow.variance[0], 5.0F * wide.variance[0]);
}

TEST(Panorama, KnowsNothingOfWhatWasNeverSeen) {
  const Panorama panorama = ramp();
  Panorama::Predicted predicted;
  panorama.predict(Panorama::of_column(150.0, 0.0, 0), 1, false, predicted);
  EXPECT_EQ(predicted.known[0], 0.0F);
  panorama.predict(Panorama::of_column(90.0, 5.0, 0), 1, false, predicted);  // half of it
  EXPECT_EQ(predicted.known[0], 0.0F);
}

TEST(Panorama, LearnsAsAKalmanFilterDoes) {
  Panorama panorama = ramp();
  const auto ray = Panorama::of_column(20.5 * bin_deg, 0.0, 0);  // one bin alone
  Panorama::Predicted before, after;
  panorama.predict(ray, 1.0, false, before);
  panorama.write(ray, column_of(before.temp_c[0] + 1.0F), column_of(0.04F));  // as sure as the map
  panorama.add_up();
  panorama.predict(ray, 1.0, false, after);
  EXPECT_NEAR(after.temp_c[3] - before.temp_c[3], 0.5, 1e-3);
  EXPECT_NEAR(after.variance[3], 0.02, 1e-3);
}

TEST(Panorama, IsNotWrittenByWhatPassesAndLearnsWhatStays) {
  Panorama panorama;
  panorama.clear(true);
  const auto ray = Panorama::of_column(20.5 * bin_deg, 0.0, 0);
  panorama.seed(ray, {.low = ray.middle - 2.0,
                      .high = ray.middle + 2.0,
                      .temp_c = column_of(20.0F),
                      .slope = column_of(0.0F),
                      .variance = column_of(0.04F)});
  const auto shown_after = [&](int halves) {
    for (int i = 0; i < halves; ++i) panorama.write(ray, column_of(30.0F), column_of(0.04F));
    panorama.add_up();
    Panorama::Predicted predicted;
    panorama.predict(ray, 1.0, false, predicted);
    return predicted.temp_c[3];
  };
  EXPECT_LT(shown_after(4), 20.1F);
  EXPECT_GT(shown_after(30), 29.0F);
}

TEST(Panorama, IsNotWrittenByAPixelThatHasNoReading) {
  Panorama panorama = ramp();
  const auto ray = Panorama::of_column(20.5 * bin_deg, 0.0, 0);
  Panorama::Predicted before, after;
  panorama.predict(ray, 1.0, false, before);
  panorama.write(ray, column_of(std::nanf("")), column_of(0.04F));
  panorama.add_up();
  panorama.predict(ray, 1.0, false, after);
  EXPECT_EQ(after.temp_c, before.temp_c);
  EXPECT_EQ(after.variance, before.variance);
}

}  // namespace
}  // namespace thermorig::odometer
