// SPDX-License-Identifier: MIT
#include "thermorig/network/trainer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <thread>
#include <vector>

#include "allocations.h"
#include "random_windows.h"
#include "reference_network.h"

namespace thermorig::network {
namespace {

constexpr double slope_agreement = 1e-4;  // of the largest value of a tensor

/// Both heads at work, so that no gradient is lost in the other's shadow.
Weights balanced_weights(const Shape& shape, std::uint64_t seed) {
  Weights weights = initial_weights(shape, seed);
  for (float& w : weights.tensor("speed3.weight")) w *= 4.0F;
  if (shape.fusion)
    for (float& w : weights.tensor("gain2.weight")) w *= 8.0F;
  return weights;
}

std::string described_step(const Shape& shape, InstructionSet set) {
  return "Nf " + std::to_string(shape.frames) + " Nr " + std::to_string(shape.reduction) +
         (shape.fusion ? " fusion" : " thermal-only") + " padding " + std::to_string(shape.padding1) + " " +
         std::to_string(shape.padding2) + " " + std::string(name_of(set));
}

void expect_near(const Shape& shape, std::span<const float> gradients, const Values& reference) {
  ASSERT_EQ(gradients.size(), reference.size());
  for (const Tensor& tensor : tensors_of(shape)) {
    double largest = 0.0, apart = 0.0;
    for (std::size_t i = tensor.offset; i < tensor.offset + tensor.size; ++i) {
      largest = std::max(largest, std::abs(reference[i]));
      apart = std::max(apart, std::abs(reference[i] - static_cast<double>(gradients[i])));
    }
    EXPECT_GT(largest, 0.0) << tensor.name;
    EXPECT_LE(apart, slope_agreement * largest) << tensor.name;
  }
}

/// Gradients and loss by every instruction set beside the reference's.
void expect_gradients(const Shape& shape, int windows, const LossConfig& loss = {}) {
  const Weights weights = balanced_weights(shape, 3);
  RandomWindows random(shape, windows, 7);
  const Batch batch = random.batch();
  const ReferenceGradients reference = ReferenceNetwork(weights).gradients(batch, loss);
  for (InstructionSet set : instruction_sets()) {
    SCOPED_TRACE(described_step(shape, set) + ", " + std::to_string(windows) + " windows");
    CallingThread workers;
    Trainer trainer(weights, {.loss = loss, .set = set}, workers);
    expect_near(shape, trainer.gradients(batch), reference.values);
    const StepLoss step = trainer.step(batch);
    EXPECT_NEAR(step.loss, reference.loss.loss, 1e-5 * reference.loss.loss);
    EXPECT_NEAR(step.squared_error, reference.loss.squared_error, 1e-5 * reference.loss.squared_error);
    EXPECT_NEAR(step.gain_mean, reference.loss.gain_mean, 1e-5);
  }
}

TEST(Trainer, GradientsAreTheReferencesForEveryNumberOfFramesAndReduction) {
  for (bool fusion : {true, false})
    for (int reduction = min_reduction; reduction <= max_reduction; ++reduction)
      for (int frames = min_frames; frames <= max_frames; ++frames)
        expect_gradients({.frames = frames, .reduction = reduction, .fusion = fusion}, 2);
}

TEST(Trainer, GradientsAreTheReferencesForEveryPaddingThatLeavesSomething) {
  int shapes = 0;
  for (int reduction = min_reduction; reduction <= max_reduction; ++reduction) {
    for (int padding1 = 0; padding1 <= 2; ++padding1) {
      for (int padding2 = 0; padding2 <= 2; ++padding2) {
        const Shape shape{.frames = 2, .reduction = reduction, .padding1 = padding1, .padding2 = padding2};
        if (fault_of(shape)) continue;
        ++shapes;
        expect_gradients(shape, 2);
      }
    }
  }
  EXPECT_EQ(shapes, 22);
}

TEST(Trainer, LanesWithoutAWindowDoNotCount) {
  for (int windows : {1, 2, 7, 8, 9, 15, 16, 17, 31, 32})
    expect_gradients({.frames = 2, .reduction = 3, .padding1 = 0}, windows);
}

TEST(Trainer, TheAuxiliaryLossReachesTheThermalSpeed) {
  for (bool fusion : {true, false})
    expect_gradients({.frames = 3, .reduction = 3, .fusion = fusion}, 5,
                     {.berhu_fraction = 0.3F, .auxiliary_thermal = 0.7F});
}

TEST(Trainer, ABatchForgetsTheOneBefore) {
  const Shape shape{.frames = 2, .reduction = 3};
  RandomWindows many(shape, 32, 1), few(shape, 3, 2);
  CallingThread workers;
  for (InstructionSet set : instruction_sets()) {
    Trainer fresh(balanced_weights(shape, 3), {.set = set}, workers);
    Trainer used(balanced_weights(shape, 3), {.set = set}, workers);
    used.gradients(many.batch());
    EXPECT_EQ(used.gradients(few.batch()), fresh.gradients(few.batch())) << name_of(set);
  }
}

TEST(Trainer, AskingForGradientsChangesNothing) {
  const Shape shape{.frames = 3, .reduction = 3};
  RandomWindows windows(shape, 4, 1);
  CallingThread workers;
  Trainer trainer(initial_weights(shape, 1), {}, workers);
  trainer.step(windows.batch());
  const Weights weights = trainer.weights();
  const OptimiserState optimiser = trainer.optimiser();
  trainer.gradients(windows.batch());
  EXPECT_EQ(trainer.weights(), weights);
  EXPECT_EQ(trainer.optimiser(), optimiser);
}

TEST(Trainer, StepsOfAdamAreTheReferences) {
  const Shape shape{.frames = 2, .reduction = 3};
  const LossConfig loss{.auxiliary_thermal = 0.5F};
  for (InstructionSet set : instruction_sets()) {
    SCOPED_TRACE(name_of(set));
    ReferenceNetwork reference(balanced_weights(shape, 5));
    CallingThread workers;
    Trainer trainer(balanced_weights(shape, 5), {.loss = loss, .set = set}, workers);
    for (std::uint64_t step = 0; step < 6; ++step) {
      RandomWindows windows(shape, 8, step);
      const double expected = reference.step(windows.batch(), loss, {}).loss;
      EXPECT_NEAR(trainer.step(windows.batch()).loss, expected, 1e-4 * expected) << "step " << step;
    }
    // A gradient near 0 may have either sign after rounding, and Adam moves by the sign: so the mean.
    const Weights weights = trainer.weights();
    double apart = 0.0;
    for (std::size_t i = 0; i < weights.values.size(); ++i)
      apart += std::abs(static_cast<double>(weights.values[i]) - reference.weights()[i]);
    EXPECT_LT(apart / static_cast<double>(weights.values.size()), 1e-6);
  }
}

TEST(Trainer, AMomentKeepsItsDirectionHoweverSmallTheGradient) {
  // Adam divides by the root of the second moment: the first step is the rate for any gradient well above
  // epsilon, and none where there is no gradient.
  const Shape shape{.frames = 2, .reduction = 3, .fusion = false};
  std::vector<float> dark(shape.inputs(), 0.0F);  // no gradient of Conv1's weights
  const std::vector<const float*> frames{dark.data()};
  const std::vector<float> label{0.5F};
  for (InstructionSet set : instruction_sets()) {
    CallingThread workers;
    const Weights before = balanced_weights(shape, 2);
    Trainer trainer(before, {.set = set}, workers);
    const auto gradients = trainer.gradients({.frames = frames, .label = label});
    trainer.step({.frames = frames, .label = label});
    const Weights after = trainer.weights();
    std::size_t moved = 0;
    for (std::size_t i = 0; i < gradients.size(); ++i) {
      const double step = static_cast<double>(before.values[i]) - static_cast<double>(after.values[i]);
      const double gradient = gradients[i];
      const double expected = 1e-3 * gradient / (std::abs(gradient) + 1e-8);
      ASSERT_NEAR(step, expected, 1e-7) << i << ' ' << name_of(set);
      if (gradient != 0.0) ++moved;
    }
    EXPECT_GT(moved, gradients.size() / 8);
    EXPECT_TRUE(std::ranges::equal(after.tensor("conv1.weight"), before.tensor("conv1.weight")));
  }
}

TEST(Trainer, WithoutAnyErrorNothingMoves) {
  const Shape shape{.frames = 2, .reduction = 3};
  Weights weights = initial_weights(shape, 1);
  std::ranges::fill(weights.tensor("speed3.weight"), 0.0F);
  std::ranges::fill(weights.tensor("speed3.bias"), 0.25F);  // y_th
  RandomWindows windows(shape, 4, 1);
  std::ranges::fill(windows.gyro, 0.25F);
  std::ranges::fill(windows.label, 0.25F);
  for (InstructionSet set : instruction_sets()) {
    CallingThread workers;
    Trainer trainer(weights, {.loss = {.auxiliary_thermal = 1.0F}, .set = set}, workers);
    const StepLoss loss = trainer.step(windows.batch());
    EXPECT_NEAR(loss.loss, 0.0, 1e-7);
    EXPECT_LT(loss.squared_error, 1e-14);
    for (float value : trainer.weights().values) ASSERT_TRUE(std::isfinite(value));
  }
}

/// Does the parts one after the other, the last first: who needs another's part of the same phase goes wrong.
class BackwardCrew final : public Workers {
 public:
  explicit BackwardCrew(int size) : size_(size) {}
  int size() const override { return size_; }
  void run(const std::function<void(int)>& work) override {
    for (int worker = size_; worker-- > 0;) work(worker);
  }

 private:
  int size_;
};

class ThreadedCrew final : public Workers {
 public:
  explicit ThreadedCrew(int size) : size_(size) {}
  int size() const override { return size_; }
  void run(const std::function<void(int)>& work) override {
    std::vector<std::thread> threads;
    for (int worker = 0; worker < size_; ++worker) threads.emplace_back(work, worker);
    for (std::thread& thread : threads) thread.join();
  }

 private:
  int size_;
};

Weights trained_by(Workers& workers, const Shape& shape, InstructionSet set) {
  Trainer trainer(initial_weights(shape, 9), {.loss = {.auxiliary_thermal = 0.5F}, .set = set}, workers);
  for (int windows : {32, 32, 19}) {
    RandomWindows random(shape, windows, 4);
    trainer.step(random.batch());
  }
  return trainer.weights();
}

TEST(Trainer, WeightsDoNotDependOnTheSizeOfTheCrew) {
  for (InstructionSet set : instruction_sets()) {
    for (const Shape& shape : {Shape{.frames = 3, .reduction = 2}, Shape{.reduction = 3, .fusion = false}}) {
      CallingThread solo;
      const Weights expected = trained_by(solo, shape, set);
      for (int size : {2, 3, 7, 40}) {
        BackwardCrew workers(size);
        EXPECT_EQ(trained_by(workers, shape, set), expected)
            << described_step(shape, set) << ", workers of " << size;
      }
      for (int size : {2, 3}) {
        ThreadedCrew workers(size);
        EXPECT_EQ(trained_by(workers, shape, set), expected)
            << described_step(shape, set) << ", threads: " << size;
      }
    }
  }
}

TEST(Trainer, GoesOnBitByBitFromWhatItSaid) {
  const Shape shape{.frames = 2, .reduction = 3, .padding1 = 1};  // features that do not fill a block
  RandomWindows windows(shape, 12, 8);
  CallingThread workers;
  for (InstructionSet set : instruction_sets()) {
    Trainer whole(initial_weights(shape, 1), {.set = set}, workers);
    for (int step = 0; step < 3; ++step) whole.step(windows.batch());
    Trainer part(initial_weights(shape, 2), {.set = set}, workers);
    part.restore(whole.weights(), whole.optimiser());
    for (int step = 0; step < 3; ++step) {
      whole.step(windows.batch());
      part.step(windows.batch());
    }
    EXPECT_EQ(part.weights(), whole.weights()) << name_of(set);
    EXPECT_EQ(part.optimiser(), whole.optimiser()) << name_of(set);
    EXPECT_EQ(part.optimiser().steps, 6U);
  }
}

TEST(Trainer, AStepAsksForNoMemory) {
  const Shape shape{.frames = 2, .reduction = 3};
  RandomWindows windows(shape, 32, 8);
  const Batch batch = windows.batch();
  CallingThread workers;
  Trainer trainer(initial_weights(shape, 1), {}, workers);
  const std::size_t before = allocations();
  trainer.step(batch);
  trainer.step(batch);
  EXPECT_EQ(allocations(), before);
}

TEST(Trainer, LearnsAFewWindowsByHeart) {
  const Shape shape{.frames = 2, .reduction = 3, .fusion = false};
  RandomWindows windows(shape, 8, 8);
  CallingThread workers;
  Trainer trainer(initial_weights(shape, 1), {}, workers);
  const double first = trainer.step(windows.batch()).squared_error;
  double last = first;
  for (int step = 0; step < 150; ++step) last = trainer.step(windows.batch()).squared_error;
  EXPECT_LT(last, 0.01 * first);
}

}  // namespace
}  // namespace thermorig::network
