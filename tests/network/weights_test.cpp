// SPDX-License-Identifier: MIT
#include "thermorig/network/weights.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

#include "thermorig/network/instruction_set.h"

namespace thermorig::network {
namespace {

TEST(Tensors, HaveTheDocumentedNamesAndDimensionsInTheirOrder) {
  const Shape shape{.frames = 4};
  const std::vector<std::pair<std::string, std::vector<int>>> documented = {
      {"conv1.weight", {6, 4, 5, 5}},  {"conv1.bias", {6}},
      {"conv2.weight", {16, 6, 5, 5}}, {"conv2.bias", {16}},
      {"speed1.weight", {120, 3072}},  {"speed1.bias", {120}},
      {"speed2.weight", {80, 120}},    {"speed2.bias", {80}},
      {"speed3.weight", {1, 80}},      {"speed3.bias", {1}},
      {"gain1.weight", {120, 3072}},   {"gain1.bias", {120}},
      {"gain2.weight", {1, 120}},      {"gain2.bias", {1}}};
  const auto tensors = tensors_of(shape);
  ASSERT_EQ(tensors.size(), documented.size());
  std::size_t offset = 0;
  for (std::size_t i = 0; i < tensors.size(); ++i) {
    EXPECT_EQ(tensors[i].name, documented[i].first);
    EXPECT_EQ(tensors[i].dimensions, documented[i].second);
    EXPECT_EQ(tensors[i].offset, offset);
    std::size_t size = 1;
    for (int dimension : tensors[i].dimensions) size *= static_cast<std::size_t>(dimension);
    EXPECT_EQ(tensors[i].size, size);
    offset += size;
  }
  EXPECT_EQ(weight_count(shape), offset);
}

TEST(Tensors, OfAThermalOnlyNetworkAreTheFirstTen) {
  const auto both = tensors_of({.reduction = 2}), thermal = tensors_of({.reduction = 2, .fusion = false});
  ASSERT_EQ(thermal.size(), 10U);
  for (std::size_t i = 0; i < thermal.size(); ++i) {
    EXPECT_EQ(thermal[i].name, both[i].name);
    EXPECT_EQ(thermal[i].offset, both[i].offset);
  }
}

TEST(Tensors, AreSeenAndChangedByName) {
  Weights weights = initial_weights({.frames = 2, .reduction = 3}, 1);
  weights.tensor("speed3.bias")[0] = 7.0F;
  EXPECT_EQ(std::count(weights.values.begin(), weights.values.end(), 7.0F), 1);
  const Weights& read = weights;
  EXPECT_EQ(read.tensor("speed3.bias")[0], 7.0F);
  EXPECT_EQ(read.tensor("conv1.weight").data(), weights.values.data());
}

TEST(InitialWeights, AreUniformWithinTheBoundOfTheirFanIn) {
  const Weights weights = initial_weights({.frames = 3, .reduction = 3}, 5);
  const std::pair<std::string, int> layers[] = {{"conv1", 3 * 25}, {"conv2", 6 * 25}, {"speed1", 320},
                                                {"speed2", 120},   {"speed3", 80},    {"gain1", 320},
                                                {"gain2", 120}};
  for (const auto& [layer, fan_in] : layers) {
    const double bound = 1.0 / std::sqrt(fan_in);
    for (const char* part : {".weight", ".bias"}) {
      SCOPED_TRACE(layer + part);
      const auto values = weights.tensor(layer + part);
      double sum = 0.0, squares = 0.0;
      for (float v : values) {
        EXPECT_LE(std::abs(static_cast<double>(v)), bound * (1.0 + 1e-7));
        sum += static_cast<double>(v) / bound;
        squares += static_cast<double>(v) * static_cast<double>(v) / (bound * bound);
      }
      const auto count = static_cast<double>(values.size());
      if (count < 100.0) continue;
      EXPECT_NEAR(sum / count, 0.0, 4.0 / std::sqrt(3.0 * count));
      EXPECT_NEAR(squares / count, 1.0 / 3.0, 4.0 * 0.3 / std::sqrt(count));
    }
  }
}

/// FNV-1a over the bits.
std::uint64_t checksum(const Weights& weights) {
  std::uint64_t sum = 14695981039346656037U;
  for (float v : weights.values)
    for (std::uint32_t bits = std::bit_cast<std::uint32_t>(v), byte = 0; byte < 4; ++byte, bits >>= 8U)
      sum = (sum ^ (bits & 0xFFU)) * 1099511628211U;
  return sum;
}

TEST(InitialWeights, AreTheSameBitsEverywhere) {
  EXPECT_EQ(checksum(initial_weights({}, 1)), 0xFCFF83481E4E1DB0U);
  EXPECT_EQ(checksum(initial_weights({.frames = 2, .reduction = 3, .fusion = false}, 42)),
            0x01B8F6D69941B7E0U);
}

TEST(InitialWeights, DependOnTheSeed) {
  const Shape shape{.frames = 2, .reduction = 3};
  EXPECT_EQ(initial_weights(shape, 1), initial_weights(shape, 1));
  EXPECT_NE(initial_weights(shape, 1), initial_weights(shape, 2));
}

TEST(InstructionSets, BeginWithWhatEveryMachineHasAndEndWithTheBest) {
  const auto sets = instruction_sets();
  ASSERT_FALSE(sets.empty());
  EXPECT_EQ(sets.front(), InstructionSet::baseline);
  EXPECT_EQ(sets.back(), best_instruction_set());
  EXPECT_TRUE(std::is_sorted(sets.begin(), sets.end()));
}

TEST(InstructionSets, HaveNamesOfTheirOwn) {
  EXPECT_EQ(name_of(InstructionSet::baseline), "baseline");
  EXPECT_EQ(name_of(InstructionSet::avx2), "AVX2");
  EXPECT_EQ(name_of(InstructionSet::avx512), "AVX-512");
}

}  // namespace
}  // namespace thermorig::network
