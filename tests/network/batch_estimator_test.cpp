// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "allocations.h"
#include "random_windows.h"
#include "reference_network.h"
#include "thermorig/network/trainer.h"

namespace thermorig::network {
namespace {

/// Windows flipped where a batch says so.
std::vector<float> as_seen(const Shape& shape, const RandomWindows& windows, std::size_t index) {
  std::vector<float> frames = windows.frames[index];
  if (!windows.mirrored[index]) return frames;
  for (auto row = frames.begin(); row != frames.end(); row += shape.columns())
    std::reverse(row, row + shape.columns());
  return frames;
}

void expect_reference(const Shape& shape, int count) {
  const Weights weights = initial_weights(shape, 11);
  const ReferenceNetwork reference(weights);
  RandomWindows windows(shape, count, 13);
  for (InstructionSet set : instruction_sets()) {
    BatchEstimator estimator(weights, set);
    std::vector<Output> outputs(static_cast<std::size_t>(count));
    estimator.estimate(windows.batch(), outputs);
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      const ReferenceOutput expected = reference.forward(as_seen(shape, windows, i), windows.gyro[i]);
      EXPECT_NEAR(outputs[i].fusion, expected.fusion, 1e-6) << name_of(set) << " window " << i;
      EXPECT_NEAR(outputs[i].thermal, expected.thermal, 1e-6) << name_of(set) << " window " << i;
      EXPECT_NEAR(outputs[i].gain, expected.gain, 1e-6) << name_of(set) << " window " << i;
    }
  }
}

TEST(BatchEstimator, OutputsAreTheReferencesForEveryNumberOfFramesAndReduction) {
  for (bool fusion : {true, false})
    for (int reduction = min_reduction; reduction <= max_reduction; ++reduction)
      for (int frames = min_frames; frames <= max_frames; ++frames)
        expect_reference({.frames = frames, .reduction = reduction, .fusion = fusion}, 2);
}

TEST(BatchEstimator, TakesOneWindowToThirtyTwo) {
  for (int count : {1, 5, 16, 31, 32}) expect_reference({.frames = 2, .reduction = 3}, count);
}

TEST(BatchEstimator, ThermalOnlyNeedsNoGyro) {
  const Shape shape{.frames = 2, .reduction = 3, .fusion = false};
  RandomWindows windows(shape, 3, 1);
  Batch batch = windows.batch();
  batch.gyro = {};
  batch.label = {};
  std::vector<Output> outputs(3);
  BatchEstimator(initial_weights(shape, 1)).estimate(batch, outputs);
  for (const Output& output : outputs) {
    EXPECT_EQ(output.fusion, output.thermal);
    EXPECT_EQ(output.gain, 1.0F);
  }
}

TEST(BatchEstimator, AsksForNoMemory) {
  const Shape shape{.frames = 2, .reduction = 3};
  RandomWindows windows(shape, 32, 1);
  const Batch batch = windows.batch();
  std::vector<Output> outputs(32);
  BatchEstimator estimator(initial_weights(shape, 1));
  const std::size_t before = allocations();
  estimator.estimate(batch, outputs);
  EXPECT_EQ(allocations(), before);
}

}  // namespace
}  // namespace thermorig::network
