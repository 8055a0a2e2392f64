// SPDX-License-Identifier: MIT
#include "thermorig/network/estimator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "allocations.h"
#include "random_windows.h"
#include "reference_network.h"

namespace thermorig::network {
namespace {

std::string described(const Shape& shape, InstructionSet set) {
  return "Nf " + std::to_string(shape.frames) + " Nr " + std::to_string(shape.reduction) +
         (shape.fusion ? " fusion" : " thermal-only") + " padding " + std::to_string(shape.padding1) + " " +
         std::to_string(shape.padding2) + " " + std::string(name_of(set));
}

/// Random first weights give speeds near 0; these reach the range of labels, with both heads at work.
Weights lively_weights(const Shape& shape, std::uint64_t seed) {
  Weights weights = initial_weights(shape, seed);
  for (float& w : weights.tensor("speed3.weight")) w *= 4.0F;
  if (shape.fusion)
    for (float& w : weights.tensor("gain2.weight")) w *= 20.0F;
  return weights;
}

void expect_near(const Output& output, const ReferenceOutput& reference, double tolerance) {
  EXPECT_NEAR(output.fusion, reference.fusion, tolerance);
  EXPECT_NEAR(output.thermal, reference.thermal, tolerance);
  EXPECT_NEAR(output.gain, reference.gain, tolerance);
}

/// Every instruction set of the machine against the reference, on two windows.
void expect_reference(const Shape& shape) {
  const Weights weights = lively_weights(shape, 17);
  const ReferenceNetwork reference(weights);
  const RandomWindows windows(shape, 2, 23);
  for (InstructionSet set : instruction_sets()) {
    SCOPED_TRACE(described(shape, set));
    Estimator estimator(weights, Precision::fp32, set);
    for (std::size_t w = 0; w < 2; ++w)
      expect_near(estimator.estimate(windows.frames[w], windows.gyro[w]),
                  reference.forward(windows.frames[w], static_cast<double>(windows.gyro[w])), 1e-5);
  }
}

TEST(Estimator, EqualsTheReferenceForEveryNumberOfFramesAndReduction) {
  for (int frames = min_frames; frames <= max_frames; ++frames)
    for (int reduction = min_reduction; reduction <= max_reduction; ++reduction)
      for (bool fusion : {true, false})
        expect_reference({.frames = frames, .reduction = reduction, .fusion = fusion});
}

TEST(Estimator, EqualsTheReferenceForEveryPaddingThatLeavesSomething) {
  int possible = 0;
  for (int reduction = min_reduction; reduction <= max_reduction; ++reduction)
    for (int padding1 : {0, 1, 2})
      for (int padding2 : {0, 1, 2}) {
        const Shape shape{.frames = 2, .reduction = reduction, .padding1 = padding1, .padding2 = padding2};
        if (fault_of(shape)) continue;
        ++possible;
        expect_reference(shape);
      }
  EXPECT_EQ(possible, 22);
}

TEST(Estimator, DiffersLittleWithWeightsInHalfPrecision) {
  const double tolerance = 0.1 / 200.0;  // 0.1 deg/s
  for (int reduction = min_reduction; reduction <= max_reduction; ++reduction) {
    const Shape shape{.frames = 3, .reduction = reduction};
    const Weights weights = lively_weights(shape, 5);
    const ReferenceNetwork reference(weights);
    const RandomWindows windows(shape, 4, 29);
    for (InstructionSet set : instruction_sets()) {
      SCOPED_TRACE(described(shape, set));
      Estimator estimator(weights, Precision::fp16_weights, set);
      for (std::size_t w = 0; w < 4; ++w)
        expect_near(estimator.estimate(windows.frames[w], windows.gyro[w]),
                    reference.forward(windows.frames[w], static_cast<double>(windows.gyro[w])), tolerance);
    }
  }
}

/// A network that hands one weight of its first speed layer through to the output.
Weights network_showing(float weight) {
  const Shape shape{.frames = 2, .reduction = 3, .fusion = false};
  Weights weights{shape, std::vector<float>(weight_count(shape))};
  weights.tensor("conv2.bias")[0] = 1.0F;  // every feature of channel 0 is 1
  weights.tensor("speed1.weight")[0] = weight;
  weights.tensor("speed2.weight")[0] = 1.0F;
  weights.tensor("speed3.weight")[0] = 1.0F;
  return weights;
}

TEST(Estimator, RoundsWeightsToTheNearestHalfAndTiesToEven) {
  struct Case {
    float weight, half;
  };
  const Case cases[] = {{0.0F, 0.0F},
                        {1.0F, 1.0F},
                        {1.0F + 0x1p-11F, 1.0F},
                        {1.0F + 0x3p-11F, 1.0F + 0x1p-9F},
                        {1.0F + 0x1.8p-11F, 1.0F + 0x1p-10F},
                        {2.0F - 0x1p-12F, 2.0F},
                        {0x1p-14F, 0x1p-14F},
                        {0x1p-24F, 0x1p-24F},          // the smallest half
                        {0x1p-25F, 0.0F},              // half of it: to even
                        {0x1.8p-25F, 0x1p-24F},        //
                        {0x1.FF8p-15F, 0x1.FF8p-15F},  // subnormal
                        {0x1.FFCp-15F, 0x1p-14F},      // up to normal
                        {65504.0F, 65504.0F},          // the largest half
                        {65519.0F, 65504.0F},          //
                        {1e9F, 65504.0F}};             // beyond: not infinite
  const std::vector<float> frames(std::size_t{2 * 8 * 10});
  for (InstructionSet set : instruction_sets())
    for (const auto& [weight, half] : cases) {
      Estimator estimator(network_showing(weight), Precision::fp16_weights, set);
      EXPECT_EQ(estimator.estimate(frames, 0.0F).thermal, half) << weight << " " << name_of(set);
      Weights negative = network_showing(-weight);
      negative.tensor("speed1.bias")[0] = 131072.0F;  // before ReLU
      Estimator below(negative, Precision::fp16_weights, set);
      EXPECT_EQ(below.estimate(frames, 0.0F).thermal, 131072.0F - half) << -weight << " " << name_of(set);
    }
}

TEST(Estimator, AllocatesNothingOnceMade) {
  for (Precision precision : {Precision::fp32, Precision::fp16_weights})
    for (InstructionSet set : instruction_sets()) {
      const Shape shape;
      const RandomWindows windows(shape, 1, 1);
      Estimator estimator(initial_weights(shape, 1), precision, set);
      const std::size_t before = allocations();
      estimator.estimate(windows.frames[0], 0.5F);
      EXPECT_EQ(allocations(), before) << name_of(set);
    }
  EXPECT_GT(allocations(), 0U);
}

TEST(Estimator, SaysTheSameAgainWhateverCameBetween) {
  const Shape shape;
  const RandomWindows windows(shape, 3, 1);
  for (InstructionSet set : instruction_sets()) {
    Estimator estimator(initial_weights(shape, 1), Precision::fp32, set);
    const Output first = estimator.estimate(windows.frames[0], 0.5F);
    estimator.estimate(windows.frames[1], -0.5F);
    estimator.estimate(windows.frames[2], 0.0F);
    const Output again = estimator.estimate(windows.frames[0], 0.5F);
    EXPECT_EQ(first.fusion, again.fusion);
    EXPECT_EQ(first.thermal, again.thermal);
    EXPECT_EQ(first.gain, again.gain);
  }
}

TEST(Estimator, IsWorthMovingAround) {
  const Shape shape{.frames = 2, .reduction = 3};
  const RandomWindows windows(shape, 1, 1);
  Estimator first(initial_weights(shape, 1));
  const float expected = first.estimate(windows.frames[0], 0.5F).fusion;
  Estimator second(initial_weights(shape, 2));
  second = std::move(first);
  EXPECT_EQ(second.estimate(windows.frames[0], 0.5F).fusion, expected);
  EXPECT_EQ(second.shape(), shape);
}

TEST(Estimator, OfAThermalOnlyNetworkTrustsTheCameraAlone) {
  const Shape shape{.frames = 2, .reduction = 3, .fusion = false};
  const RandomWindows windows(shape, 1, 1);
  Estimator estimator(initial_weights(shape, 1));
  const Output output = estimator.estimate(windows.frames[0], 0.5F);
  EXPECT_EQ(output.fusion, output.thermal);
  EXPECT_EQ(output.gain, 1.0F);
  EXPECT_EQ(estimator.estimate(windows.frames[0], std::nanf("")).fusion, output.fusion);
}

TEST(Estimator, SaturatesTheGainWithoutANan) {
  const Shape shape{.frames = 2, .reduction = 3};
  const RandomWindows windows(shape, 1, 1);
  for (float bias : {-1e30F, 1e30F}) {
    Weights weights = initial_weights(shape, 1);
    weights.tensor("gain2.bias")[0] = bias;
    const Output output = Estimator(weights).estimate(windows.frames[0], 0.5F);
    EXPECT_EQ(output.gain, bias > 0.0F ? 1.0F : 0.0F);
    EXPECT_EQ(output.fusion, bias > 0.0F ? output.thermal : 0.5F);
  }
}

}  // namespace
}  // namespace thermorig::network
