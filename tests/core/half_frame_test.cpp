// SPDX-License-Identifier: MIT
#include "thermorig/core/surroundings/half_frame.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/at_s.h"

namespace thermorig {
namespace {

/// Each pixel shows its row and column, and all of it is new and timed.
TimedFrame new_frame() {
  TimedFrame frame;
  for (std::size_t i = 0; i < frame_pixels; ++i)
    frame.frame.temp_c[i] =
        static_cast<float>(i / frame_columns) + 0.01F * static_cast<float>(i % frame_columns);
  frame.fresh_even = frame.fresh_odd = half_pixels;
  frame.half = {HalfExposure{at_s(1.125), at_s(1.25)}, HalfExposure{at_s(1.0), at_s(1.125)}};
  return frame;
}

TEST(HalfFrame, HoldsThePixelsOfItsHalfColumnAfterColumn) {
  const auto half = half_of(new_frame(), 1, at_s(0.0));
  ASSERT_TRUE(half);
  for (const std::size_t column : {0U, 1U, 31U})
    for (const std::size_t k : {0U, 11U}) {
      const std::size_t row = row_of(column, k, 1);
      EXPECT_EQ(subpage_of(row, column), 1U);
      EXPECT_FLOAT_EQ(half->temp_c[column * half_rows + k],
                      static_cast<float>(row) + 0.01F * static_cast<float>(column));
    }
  EXPECT_DOUBLE_EQ(half->begin_s, 1.0);
  EXPECT_DOUBLE_EQ(half->end_s, 1.125);
}

TEST(HalfFrame, HasNoReadingBeyondTheSensorsRange) {
  TimedFrame frame = new_frame();
  frame.frame.temp_c[0] = 400.0F;
  frame.frame.temp_c[2] = 400.1F;
  frame.frame.temp_c[4] = -60.1F;
  frame.frame.temp_c[6] = std::nanf("");
  const HalfPixels pixels = pixels_of(frame.frame, 0);
  EXPECT_EQ(pixels[0], 400.0F);
  for (const std::size_t column : {2U, 4U, 6U}) EXPECT_TRUE(std::isnan(pixels[column * half_rows]));
}

TEST(HalfFrame, IsNoneWhereNothingIsNewOrItsTimeIsNotKnown) {
  const auto is_taken = [](auto change) {
    TimedFrame frame = new_frame();
    change(frame);
    return half_of(frame, 0, at_s(0.0)).has_value();
  };
  EXPECT_TRUE(is_taken([](TimedFrame&) {}));
  EXPECT_FALSE(is_taken([](TimedFrame& frame) { frame.fresh_even = Freshness::threshold; }));
  EXPECT_FALSE(is_taken([](TimedFrame& frame) { frame.late = true; }));
  EXPECT_FALSE(is_taken([](TimedFrame& frame) { frame.stale = true; }));
  EXPECT_FALSE(is_taken([](TimedFrame& frame) { frame.stands_in = true; }));
  EXPECT_FALSE(is_taken([](TimedFrame& frame) { frame.stamp.uncertainty_s = std::nanf(""); }));
  EXPECT_FALSE(is_taken([](TimedFrame& frame) { frame.half[0].end = frame.half[0].begin; }));
  EXPECT_FALSE(is_taken([](TimedFrame& frame) { frame.half[0].end = at_s(6.0); }));  // none is so long
}

TEST(TimedFrame, NamesTheHalfThatWasExposedLast) {
  EXPECT_EQ(new_frame().halves_by_time(), (std::array{1U, 0U}));
}

}  // namespace
}  // namespace thermorig
