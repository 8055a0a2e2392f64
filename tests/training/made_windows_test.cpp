// SPDX-License-Identifier: MIT
#include "learning/training/made_windows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "thermorig/learning/training/fit.h"
#include "thermorig/learning/training/prediction.h"
#include "thermorig/learning/training/thread_pool.h"
#include "trained.h"

namespace thermorig::training {
namespace {

TrainingConfig config_of(int steps, int epochs) {
  TrainingConfig config = preset("best");
  config.shape = {.frames = 2, .reduction = 3};
  config.epochs = epochs;
  config.made = {.windows = config.batch, .steps_an_epoch = steps, .rounds_kept = 2};
  return config;
}

TEST(MadeRooms, GiveTheSameBitsWithOneTwoAndThreeThreads) {
  const TrainingConfig config = config_of(70, 1);
  const TrainingResult solo = trained(config, {});
  for (const int threads : {2, 3}) {
    ThreadPool workers(threads);
    EXPECT_EQ(train(config, {}, workers).model.weights, solo.model.weights) << threads;
  }
}

TEST(MadeRooms, GoOnFromAnyEpochAsIfTheyHadNeverStopped) {
  const TrainingConfig config = config_of(50, 3);  // an epoch ends within a round
  std::vector<Checkpoint> checkpoints;
  Observer observer;
  observer.epoch = [&](const EpochReport&, const Checkpoint& checkpoint) {
    checkpoints.push_back(checkpoint);
  };
  const TrainingResult whole = trained(config, {}, observer);
  for (const Checkpoint& checkpoint : checkpoints)
    EXPECT_EQ(model::to_onnx(trained(config, {}, {}, checkpoint).model), model::to_onnx(whole.model));
}

TEST(MadeRooms, TeachTheSpeedInRoomsThatNobodyMadeUp) {
  TrainingConfig config = config_of(1500, 1);
  config.shape.fusion = false;
  config.made.rounds_kept = 12;
  config.made.view.mirrored = false;     // as the synthetic camera
  config.made.view.half_frames = false;  // the same, but exposed all at once
  const auto rooms = small_data();
  const model::Model model = trained(config, {}).model;
  // Labels of +-75 and +-150 deg/s: who says 0 always has 0.35.
  EXPECT_LT(fits_of(model, config, rooms).training.thermal_mse, 0.1);
  EXPECT_TRUE(model.provenance.simulated);
  EXPECT_EQ(model.provenance.made_windows, 48'000U);
  EXPECT_EQ(model.provenance.view, config.made.view);
  EXPECT_TRUE(model.provenance.training.empty());
}

TEST(MadeRooms, AreMixedIntoEachBatchOfRecordings) {
  TrainingConfig config = config_of(1, 2);
  config.made.windows = 8;
  const auto data = small_data();
  const TrainingResult result = trained(config, data);
  EXPECT_EQ(result.windows, 176U);
  EXPECT_EQ(result.model.provenance.made_windows, 2U * 8 * 8);  // 8 batches of 24 recorded windows
  EXPECT_EQ(result.model.provenance.training.size(), 4U);
}

TEST(Beginning, GoesOnWithTheWeightsOfAnotherTraining) {
  TrainingConfig config = preset("best");
  config.shape = {.frames = 2, .reduction = 3};
  config.epochs = 1;
  const auto data = small_data();
  const TrainingResult first = trained(config, data);
  config.from = std::make_shared<Beginning>(Beginning{"the first", first.model.weights});
  config.adam.rate = 1e-12F;
  const TrainingResult second = trained(config, data);
  EXPECT_NEAR(fits_of(second.model, config, data).training.network_mse,
              fits_of(first.model, config, data).training.network_mse, 1e-6);
  EXPECT_EQ(second.model.provenance.begun_from, "the first");
}

TEST(Gate, StatesASigmaThatTwoThirdsOfTheErrorsLieWithin) {
  TrainingConfig config = preset("best");
  config.shape = {.frames = 2, .reduction = 3};
  config.epochs = 2;
  const auto data = small_data();
  const model::Model model = trained(config, data).model;
  const std::vector<WindowEstimate> estimates =
      predict(model, data, network::find_windows(data, config.shape.frames, 0));
  const auto within = std::count_if(estimates.begin(), estimates.end(), [](const WindowEstimate& one) {
    return std::abs(one.thermal_dps - one.label_dps) < one.thermal_sigma_dps;
  });
  EXPECT_NEAR(static_cast<double>(within) / static_cast<double>(estimates.size()), 0.683, 0.06);
}

}  // namespace
}  // namespace thermorig::training
