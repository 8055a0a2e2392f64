// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <span>
#include <utility>

#include "thermorig/core/frame.h"
#include "thermorig/learning/training/fit.h"
#include "thermorig/learning/training/thread_pool.h"
#include "thermorig/network/stored_frames.h"
#include "trained.h"

namespace thermorig::training {
namespace {

using network::Acquisition;

/// Trainings with packed frames, beside the same with floats.
class PackedFramesOfATraining : public testing::Test {
 protected:
  /// The acquisitions, all but the first so many packed.
  static std::vector<Acquisition> packed(std::vector<Acquisition> acquisitions, std::size_t floats) {
    for (Acquisition& acquisition : std::span(acquisitions).subspan(floats))
      acquisition.packed = std::make_shared<network::PackedFrames>(std::exchange(acquisition.temp_c, {}));
    return acquisitions;
  }

  /// small_data() as a camera sends it: whole hundredths of a degree.
  static std::vector<Acquisition> hundredths() {
    auto acquisitions = small_data();
    for (Acquisition& acquisition : acquisitions)
      for (float& temp_c : acquisition.temp_c) temp_c = std::round(temp_c * 100.0F) / 100.0F;
    return acquisitions;
  }

  static TrainingConfig config_of(int frames, int reduction) {
    TrainingConfig config = preset("best");
    config.shape = {.frames = frames, .reduction = reduction};
    config.choose_epoch = true;
    config.epochs = 2;
    config.batch = 7;  // the last batch is short
    return config;
  }
};

void expect_same(const TrainingResult& one, const TrainingResult& other) {
  EXPECT_EQ(model::to_onnx(one.model), model::to_onnx(other.model));
  ASSERT_EQ(one.epochs.size(), other.epochs.size());
  for (std::size_t i = 0; i < one.epochs.size(); ++i) {
    EXPECT_EQ(one.epochs[i].loss, other.epochs[i].loss);
    EXPECT_EQ(one.epochs[i].held_out_mse, other.epochs[i].held_out_mse);
  }
}

TEST_F(PackedFramesOfATraining, GiveTheSameModelBitForBit) {
  for (const auto& data : {small_data(), hundredths()})
    for (const int reduction : {1, 2, 3}) {
      const TrainingConfig config = config_of(2 + reduction, reduction);
      expect_same(trained(config, packed(data, 0)), trained(config, data));
    }
}

TEST_F(PackedFramesOfATraining, GiveTheSameHoweverManyAreFloats) {
  const auto data = small_data();
  const TrainingConfig config = config_of(2, 3);
  const TrainingResult from_floats = trained(config, data);
  for (const std::size_t fit : {1U, 2U, 3U}) expect_same(trained(config, packed(data, fit)), from_floats);
}

TEST_F(PackedFramesOfATraining, GiveTheSameWithSeveralThreads) {
  const auto data = small_data();
  const TrainingConfig config = config_of(2, 3);
  ThreadPool workers(3);
  expect_same(train(config, packed(data, 1), workers), trained(config, data));
}

TEST_F(PackedFramesOfATraining, AreJudgedAsFloats) {
  const auto data = small_data();
  const TrainingConfig config = config_of(2, 3);
  const model::Model model = trained(config, data).model;
  const Fits from_floats = fits_of(model, config, data),
             from_packed = fits_of(model, config, packed(data, 0));
  EXPECT_EQ(from_floats.training.network_mse, from_packed.training.network_mse);
  ASSERT_TRUE(from_packed.held_out);
  EXPECT_EQ(from_floats.held_out->thermal_mse, from_packed.held_out->thermal_mse);
}

TEST_F(PackedFramesOfATraining, MayBeStoppedInTheMidstOfAnEpoch) {
  int steps = 0;
  Observer observer;
  observer.stop = [&] { return ++steps == 3; };
  EXPECT_TRUE(trained(config_of(2, 3), packed(small_data(), 0), observer).stopped);
}

}  // namespace
}  // namespace thermorig::training
