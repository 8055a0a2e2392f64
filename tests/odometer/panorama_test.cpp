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
Panorama ramp(bool rows_look_apart = false) {
  Panorama panorama;
  panorama.clear(rows_look_apart);
  for (const std::size_t row_class : {0U, 1U})
    for (double azimuth_deg = -90.0; azimuth_deg <= 90.0; azimuth_deg += bin_deg) {
      const auto place = Panorama::place(azimuth_deg, 0.0, row_class);
      panorama.seed(place, {.low = place.middle - 0.5,
                            .high = place.middle - 0.5,
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
      Panorama::Look look;
      panorama.look(Panorama::place(azimuth_deg, half_width_deg, 1), 1, false, look);
      EXPECT_EQ(look.known[5], 1.0F);
      EXPECT_NEAR(look.temp_c[5], azimuth_deg, 0.6) << half_width_deg;
      EXPECT_NEAR(look.of_azimuth.slope[5], 1.0, 0.02) << half_width_deg;
    }
}

TEST(Panorama, ShowsAPixelByItselfWhatItShowsItsWholeColumn) {
  const Panorama by_column = ramp(), by_row = ramp(true);
  for (const double azimuth_deg : {-40.0, 0.3, 88.0, 150.0})  // seen, and not
    for (const bool smooth : {false, true}) {
      const auto place = Panorama::place(azimuth_deg, 3.0, 1);
      Panorama::Look column, row;
      by_column.look(place, 2, smooth, column);
      for (std::size_t k = 0; k < half_rows; ++k) {
        by_row.look_row(place, k, 2, smooth, row);
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
  Panorama::Look narrow, wide;
  panorama.look(Panorama::place(10.0, 0.0, 0), 1, false, narrow);
  panorama.look(Panorama::place(10.0, 5.0 * bin_deg, 0), 1, false, wide);
  EXPECT_NEAR(wide.variance[0], 0.04 / 10.0, 1e-3);
  EXPECT_GT(narrow.variance[0], 5.0F * wide.variance[0]);
}

TEST(Panorama, KnowsNothingOfWhatWasNeverSeen) {
  const Panorama panorama = ramp();
  Panorama::Look look;
  panorama.look(Panorama::place(150.0, 0.0, 0), 1, false, look);
  EXPECT_EQ(look.known[0], 0.0F);
  panorama.look(Panorama::place(90.0, 5.0, 0), 1, false, look);  // half of it
  EXPECT_EQ(look.known[0], 0.0F);
}

TEST(Panorama, LearnsAsAKalmanFilterDoes) {
  Panorama panorama = ramp();
  const auto place = Panorama::place(20.5 * bin_deg, 0.0, 0);  // one bin alone
  Panorama::Look before, after;
  panorama.look(place, 1.0, false, before);
  panorama.write(place, column_of(before.temp_c[0] + 1.0F), column_of(0.04F));  // as sure as the map
  panorama.add_up();
  panorama.look(place, 1.0, false, after);
  EXPECT_NEAR(after.temp_c[3] - before.temp_c[3], 0.5, 1e-3);
  EXPECT_NEAR(after.variance[3], 0.02, 1e-3);
}

TEST(Panorama, IsNotWrittenByWhatPassesAndLearnsWhatStays) {
  Panorama panorama;
  panorama.clear(false, true);
  const auto place = Panorama::place(20.5 * bin_deg, 0.0, 0);
  panorama.seed(place, {.low = place.middle - 2.0,
                        .high = place.middle + 2.0,
                        .temp_c = column_of(20.0F),
                        .slope = column_of(0.0F),
                        .variance = column_of(0.04F)});
  const auto shown_after = [&](int halves) {
    for (int i = 0; i < halves; ++i) panorama.write(place, column_of(30.0F), column_of(0.04F));
    panorama.add_up();
    Panorama::Look look;
    panorama.look(place, 1.0, false, look);
    return look.temp_c[3];
  };
  EXPECT_LT(shown_after(4), 20.1F);
  EXPECT_GT(shown_after(30), 29.0F);
}

TEST(Panorama, IsNotWrittenByAPixelThatHasNoReading) {
  Panorama panorama = ramp();
  const auto place = Panorama::place(20.5 * bin_deg, 0.0, 0);
  Panorama::Look before, after;
  panorama.look(place, 1.0, false, before);
  panorama.write(place, column_of(std::nanf("")), column_of(0.04F));
  panorama.add_up();
  panorama.look(place, 1.0, false, after);
  EXPECT_EQ(after.temp_c, before.temp_c);
  EXPECT_EQ(after.variance, before.variance);
}

}  // namespace
}  // namespace thermorig::odometer
