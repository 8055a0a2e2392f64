// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "boards.h"
#include "quantised_model.h"

namespace thermorig::tests {
namespace {

const network::Shape shape{.frames = 2, .reduction = 3};

TEST(Quantisation, MovesNoWeightByMoreThanHalfAStepOfItsRow) {
  const model::Model model = random_model(shape, 7), small = quantised(model);
  const auto before = model.weights.tensor("speed1.weight"), after = small.weights.tensor("speed1.weight");
  const std::size_t row_size = before.size() / network::hidden1;
  bool moved = false;
  for (std::size_t begin = 0; begin < before.size(); begin += row_size) {
    float most = 0.0F;
    for (float weight : before.subspan(begin, row_size)) most = std::max(most, std::abs(weight));
    for (std::size_t i = begin; i < begin + row_size; ++i) {
      EXPECT_LE(std::abs(after[i] - before[i]), 0.5001F * most / 127.0F);
      moved = moved || after[i] != before[i];
    }
  }
  EXPECT_TRUE(moved);
}

TEST(Quantisation, OfItsOwnResultChangesNothingMore) {
  const model::Model once = quantised(random_model(shape, 7));
  const model::Model twice = quantised(once);
  for (std::size_t i = 0; i < once.weights.values.size(); ++i)
    EXPECT_NEAR(twice.weights.values[i], once.weights.values[i], 1e-6F * std::abs(once.weights.values[i]));
}

TEST(Quantisation, LeavesBiasesAndSmallLayersAsTheyAre) {
  const model::Model model = random_model(shape, 7), small = quantised(model);
  for (const char* name :
       {"conv1.bias", "speed1.bias", "speed2.weight", "speed3.weight", "gain2.weight", "gain2.bias"}) {
    const auto before = model.weights.tensor(name), after = small.weights.tensor(name);
    EXPECT_TRUE(std::equal(before.begin(), before.end(), after.begin())) << name;
  }
}

TEST(Quantisation, KeepsRowsOfZerosAndOfTheTiniestNumbersFinite) {
  model::Model model = random_model(shape, 7);
  const auto weights = model.weights.tensor("gain1.weight");
  const auto row = static_cast<std::size_t>(shape.features());
  std::fill_n(weights.begin(), row, 0.0F);
  std::fill_n(weights.begin() + shape.features(), row, 1e-45F);
  const auto small = quantised(model);
  const auto after = small.weights.tensor("gain1.weight");
  for (std::size_t i = 0; i < row; ++i) EXPECT_EQ(after[i], 0.0F);
  for (float weight : after) EXPECT_TRUE(std::isfinite(weight));
}

}  // namespace
}  // namespace thermorig::tests
