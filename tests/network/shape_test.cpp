// SPDX-License-Identifier: MIT
#include "thermorig/network/shape.h"

#include <gtest/gtest.h>

#include <functional>

namespace thermorig::network {
namespace {

void for_each_shape(const std::function<void(const Shape&)>& look) {
  for (int frames = min_frames; frames <= max_frames; ++frames)
    for (int reduction = min_reduction; reduction <= max_reduction; ++reduction)
      for (bool fusion : {true, false})
        for (int padding1 : {0, 1, 2})
          for (int padding2 : {0, 1, 2})
            look({.frames = frames,
                  .reduction = reduction,
                  .fusion = fusion,
                  .padding1 = padding1,
                  .padding2 = padding2});
}

/// Places where a filter of 5 lies inside `size` pixels and their padding.
int places(int size, int padding) {
  int count = 0;
  for (int first = -padding; first + 4 <= size - 1 + padding; ++first) ++count;
  return count;
}

/// Weights and multiply-adds counted layer by layer, beside the formulas of the library.
struct Count {
  std::uint64_t weights = 0, multiply_adds = 0;

  void convolution(int inputs, int filters, int positions) {
    weights += static_cast<std::uint64_t>(filters * (inputs * 25 + 1));
    multiply_adds += static_cast<std::uint64_t>(filters * inputs * 25 * positions);
  }
  void dense(int inputs, int outputs) {
    weights += static_cast<std::uint64_t>(outputs * (inputs + 1));
    multiply_adds += static_cast<std::uint64_t>(outputs * inputs);
  }
};

Count count_of(const Shape& shape) {
  Count count;
  const int rows1 = places(24 / shape.reduction, shape.padding1);
  const int columns1 = places(32 / shape.reduction, shape.padding1);
  const int rows2 = places(rows1 / 2, shape.padding2), columns2 = places(columns1 / 2, shape.padding2);
  count.convolution(shape.frames, 6, rows1 * columns1);
  count.convolution(6, 16, rows2 * columns2);
  count.dense(16 * rows2 * columns2, 120);
  count.dense(120, 80);
  count.dense(80, 1);
  if (!shape.fusion) return count;
  count.dense(16 * rows2 * columns2, 120);
  count.dense(120, 1);
  return count;
}

TEST(Shape, CountsAreThoseOfItsLayers) {
  int possible = 0;
  for_each_shape([&](const Shape& shape) {
    if (fault_of(shape)) return;
    ++possible;
    const Count count = count_of(shape);
    EXPECT_EQ(weight_count(shape), count.weights);
    EXPECT_EQ(multiply_adds(shape), count.multiply_adds);
  });
  EXPECT_EQ(possible, 5 * 2 * 22);
}

TEST(Shape, WeightsAtThreeFramesAreTheDocumentedOnes) {
  const auto weights = [](int reduction, bool fusion) {
    return weight_count({.frames = 3, .reduction = reduction, .fusion = fusion});
  };
  EXPECT_EQ(weights(1, false), 381'393U);
  EXPECT_EQ(weights(2, false), 104'913U);
  EXPECT_EQ(weights(3, false), 51'153U);
  EXPECT_EQ(weights(1, true), 750'274U);
  EXPECT_EQ(weights(2, true), 197'314U);
  EXPECT_EQ(weights(3, true), 89'794U);
  EXPECT_EQ(multiply_adds({}), 1'553'480U);
}

TEST(Shape, IsRefusedExactlyWhereALayerHasNothingLeft) {
  for_each_shape([](const Shape& shape) {
    const int rows1 = places(24 / shape.reduction, shape.padding1);
    const int columns1 = places(32 / shape.reduction, shape.padding1);
    const bool left = rows1 / 2 > 0 && columns1 / 2 > 0 && places(rows1 / 2, shape.padding2) > 0 &&
                      places(columns1 / 2, shape.padding2) > 0;
    EXPECT_EQ(fault_of(shape).has_value(), !left);
  });
}

// Without padding, three pixels averaged to one leave the second convolution two rows for its five.
TEST(Shape, WithoutPaddingOnlyFullResolutionFits) {
  EXPECT_FALSE(fault_of({.reduction = 1, .padding1 = 0, .padding2 = 0}));
  EXPECT_TRUE(fault_of({.reduction = 2, .padding1 = 0, .padding2 = 0}));
  EXPECT_TRUE(fault_of({.reduction = 3, .padding1 = 0, .padding2 = 0}));
}

TEST(Shape, IsRefusedWithASentenceWhereverAFieldIsOutOfRange) {
  const Shape wrong[] = {{.frames = 1},
                         {.frames = 7},
                         {.frames = -3},
                         {.frames = 2'000'000'000},
                         {.reduction = 0},
                         {.reduction = 4},
                         {.padding1 = -1},
                         {.padding1 = 3},
                         {.padding2 = -1},
                         {.padding2 = 3},
                         {.crop_left = 1},
                         {.crop_left = -1},
                         {.reduction = 3, .crop_left = 3}};
  for (const Shape& shape : wrong) {
    const auto fault = fault_of(shape);
    ASSERT_TRUE(fault);
    EXPECT_GT(fault->size(), 20U);
  }
  EXPECT_FALSE(fault_of({.reduction = 3, .crop_left = 2}));
}

}  // namespace
}  // namespace thermorig::network
