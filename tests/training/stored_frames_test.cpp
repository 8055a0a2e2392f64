// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "../session/temporary_folder.h"
#include "thermorig/core/error.h"
#include "thermorig/core/frame.h"
#include "thermorig/learning/dataset/frame_store.h"
#include "thermorig/learning/training/fit.h"
#include "thermorig/learning/training/thread_pool.h"
#include "trained.h"

namespace thermorig::training {
namespace {

using network::Acquisition;

/// Trainings whose frames lie on a disk, beside the same in memory.
class StoredFramesOfATraining : public session::InTemporaryFolder {
 protected:
  /// The acquisitions, of which so many fit in memory.
  std::vector<Acquisition> stored(std::vector<Acquisition> acquisitions, std::size_t in_memory) const {
    const std::size_t frame_bytes = frame_pixels * sizeof(float);  // at most
    dataset::FrameStore store({.folder = folder_}, in_memory * acquisitions.front().frames() * frame_bytes);
    for (Acquisition& acquisition : acquisitions) store.take(acquisition);
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

TEST_F(StoredFramesOfATraining, GiveTheSameModelBitForBit) {
  for (const auto& data : {small_data(), hundredths()})
    for (const int reduction : {1, 2, 3}) {
      const TrainingConfig config = config_of(2 + reduction, reduction);
      expect_same(trained(config, stored(data, 0)), trained(config, data));
    }
}

TEST_F(StoredFramesOfATraining, GiveTheSameHoweverManyFitInMemory) {
  const auto data = small_data();
  const TrainingConfig config = config_of(2, 3);
  const TrainingResult in_memory = trained(config, data);
  for (const std::size_t fit : {1U, 2U, 3U}) expect_same(trained(config, stored(data, fit)), in_memory);
}

TEST_F(StoredFramesOfATraining, GiveTheSameWithSeveralThreads) {
  const auto data = small_data();
  const TrainingConfig config = config_of(2, 3);
  ThreadPool workers(3);
  expect_same(train(config, stored(data, 1), workers), trained(config, data));
}

TEST_F(StoredFramesOfATraining, AreJudgedAsThoseInMemory) {
  const auto data = small_data();
  const TrainingConfig config = config_of(2, 3);
  const model::Model model = trained(config, data).model;
  const Fits in_memory = fits_of(model, config, data), on_disk = fits_of(model, config, stored(data, 0));
  EXPECT_EQ(in_memory.training.network_mse, on_disk.training.network_mse);
  ASSERT_TRUE(on_disk.held_out);
  EXPECT_EQ(in_memory.held_out->thermal_mse, on_disk.held_out->thermal_mse);
}

TEST_F(StoredFramesOfATraining, MayBeStoppedInTheMidstOfAnEpoch) {
  int steps = 0;
  Observer observer;
  observer.stop = [&] { return ++steps == 3; };
  EXPECT_TRUE(trained(config_of(2, 3), stored(small_data(), 0), observer).stopped);
}

/// A disk that reads so often and then fails.
class FailingDisk final : public network::StoredFrames {
 public:
  explicit FailingDisk(int reads) : left_(reads) {}

  void read(std::size_t, std::span<float> temp_c) const override {
    if (left_-- <= 0) throw Error(ExitCode::storage, "the disk has failed", "disk", "another one");
    std::fill(temp_c.begin(), temp_c.end(), 20.0F);
  }
  void announce(std::size_t, std::size_t) const override {}

 private:
  mutable std::atomic<int> left_;
};

TEST_F(StoredFramesOfATraining, ThatCannotBeReadEndTheTraining) {
  for (const int reads : {0, 4, 60}) {  // while pixels are averaged; in the first batch; in a later one
    auto data = small_data();
    for (Acquisition& acquisition : data) {
      acquisition.stored = std::make_shared<FailingDisk>(reads);
      acquisition.temp_c.clear();
    }
    try {
      trained(config_of(2, 3), data);
      ADD_FAILURE() << reads;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::storage) << reads;
    }
  }
}

}  // namespace
}  // namespace thermorig::training
