// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>

#include "support/synthetic_acquisitions.h"
#include "thermorig/core/frame.h"
#include "thermorig/network/scaling.h"

namespace thermorig::network {
namespace {

/// Frames of one temperature each.
Acquisition of_temperatures(const std::vector<float>& temps_c, std::vector<std::uint32_t> runs) {
  Acquisition acquisition;
  for (const float temp_c : temps_c)
    acquisition.temp_c.insert(acquisition.temp_c.end(), frame_pixels, temp_c);
  acquisition.run = std::move(runs);
  return acquisition;
}

/// A frame whose pixel says where it is: 100 * row + column.
std::vector<float> map_frame() {
  std::vector<float> frame;
  for (std::size_t row = 0; row < frame_rows; ++row)
    for (std::size_t column = 0; column < frame_columns; ++column)
      frame.push_back(static_cast<float>(100 * row + column));
  return frame;
}

std::vector<float> prepared(const network::Shape& shape, const Scaling& scaling = {}) {
  std::vector<float> out(shape.pixels());
  prepare_frame(map_frame(), shape, scaling, out);
  return out;
}

TEST(Scaling, IsMeanAndDeviationOfAllPixels) {
  const Acquisition acquisition = of_temperatures({20.0F, 30.0F, 40.0F, 30.0F}, {1, 1, 2, 2});
  const Scaling scaling = scaling_of({&acquisition, 1}, 150.0F);
  EXPECT_FLOAT_EQ(scaling.temp_mean_c, 30.0F);
  EXPECT_FLOAT_EQ(scaling.temp_deviation_c, std::sqrt(50.0F));
  EXPECT_EQ(scaling.label_scale_dps, 150.0F);
}

TEST(Scaling, LeavesOutFramesThatAreNotValid) {
  const Acquisition acquisition = of_temperatures({20.0F, 30.0F, 390.0F}, {1, 1, 0});
  EXPECT_FLOAT_EQ(scaling_of({&acquisition, 1}).temp_mean_c, 25.0F);
}

TEST(Scaling, LeavesOutTheAcquisitionThatItIsTold) {
  const std::vector<Acquisition> three{of_temperatures({20.0F, 22.0F}, {1, 1}),
                                       of_temperatures({90.0F, 10.0F}, {1, 1}),
                                       of_temperatures({30.0F, 32.0F}, {1, 1})};
  const std::vector<Acquisition> two{three[0], three[2]};
  EXPECT_EQ(scaling_of(three, 200.0F, 1), scaling_of(two));
  EXPECT_NE(scaling_of(three), scaling_of(two));
}

TEST(Scaling, StaysUsableWithoutAFrameOrWithoutContrast) {
  EXPECT_EQ(scaling_of({}), Scaling{});
  const Acquisition grey = of_temperatures({30.0F, 30.0F}, {1, 1});
  EXPECT_EQ(scaling_of({&grey, 1}).temp_deviation_c, 1.0F);
}

TEST(PrepareFrame, TakesPixelsAsTheyAreForNr1) {
  const std::vector<float> out = prepared({.reduction = 1}, {200.0F, 10.0F, 4.0F});
  ASSERT_EQ(out.size(), frame_pixels);
  EXPECT_FLOAT_EQ(out[0], (0.0F - 10.0F) / 4.0F);
  EXPECT_FLOAT_EQ(out[3 * frame_columns + 7], (307.0F - 10.0F) / 4.0F);
}

TEST(PrepareFrame, AveragesBlocks) {
  const std::vector<float> out = prepared({.reduction = 2});
  ASSERT_EQ(out.size(), 12U * 16U);
  EXPECT_FLOAT_EQ(out[0], 50.5F);                    // of 0, 1, 100, 101
  EXPECT_FLOAT_EQ(out[2 * 16 + 5], 450.0F + 10.5F);  // rows 4, 5; columns 10, 11
}

TEST(PrepareFrame, CropsTheColumnsThatFillNoBlock) {
  const std::vector<float> right = prepared({.reduction = 3});
  ASSERT_EQ(right.size(), 8U * 10U);
  EXPECT_FLOAT_EQ(right[0], 101.0F);          // rows 0..2, columns 0..2
  EXPECT_FLOAT_EQ(right[9], 100.0F + 28.0F);  // columns 27..29: 30 and 31 are dropped
  const std::vector<float> middle = prepared({.reduction = 3, .crop_left = 1});
  EXPECT_FLOAT_EQ(middle[9], 100.0F + 29.0F);
}

TEST(Prepare, LaysFramesBehindEachOtherSoThatAWindowIsAPart) {
  const Acquisition acquisition = synthetic::make_acquisition("garden", 1, 7, {.frames_per_leg = 3});
  const network::Shape shape{.reduction = 3};
  const Scaling scaling = scaling_of({&acquisition, 1});
  const std::vector<float> all = prepare(acquisition, shape, scaling);
  ASSERT_EQ(all.size(), acquisition.frames() * shape.pixels());
  std::vector<float> third(shape.pixels());
  prepare_frame(std::span(acquisition.temp_c).subspan(2 * frame_pixels, frame_pixels), shape, scaling, third);
  EXPECT_TRUE(
      std::equal(third.begin(), third.end(), all.begin() + static_cast<std::ptrdiff_t>(2 * shape.pixels())));
}

}  // namespace
}  // namespace thermorig::network
