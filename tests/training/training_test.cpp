// SPDX-License-Identifier: MIT
#include "thermorig/learning/training/training.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "thermorig/core/error.h"
#include "thermorig/learning/training/fit.h"
#include "thermorig/learning/training/thread_pool.h"
#include "thermorig/network/window_index.h"
#include "trained.h"

namespace thermorig::training {
namespace {

using network::Acquisition;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

template <typename Action>
Error refusal(Action action) {
  try {
    action();
  } catch (const Error& error) {
    return error;
  }
  return {ExitCode::ok, "nothing was refused", "", ""};
}

TEST(Training, LearnsTheSpeedFromTheImagesAlone) {
  const auto data = small_data();
  TrainingConfig config = small_config(30);
  config.shape.fusion = false;
  const TrainingResult result = trained(config, data);
  ASSERT_EQ(result.epochs.size(), 30U);
  // Labels of +-75 and +-150 deg/s: who says 0 always has (0.375^2 + 0.75^2) / 2 = 0.35.
  EXPECT_LT(result.epochs.back().training_mse, 0.05);
  EXPECT_LT(fits_of(result.model, config, data).training.network_mse, 0.05);
}

TEST(Training, GivesTheSameBitsAgain) {
  const auto data = small_data();
  const TrainingConfig config = small_config();
  EXPECT_EQ(model::to_onnx(trained(config, data).model), model::to_onnx(trained(config, data).model));
}

TEST(Training, DependsOnTheSeed) {
  const auto data = small_data();
  TrainingConfig config = small_config(1);
  const TrainingResult one = trained(config, data);
  config.seed = 2;
  EXPECT_NE(one.model.weights.values, trained(config, data).model.weights.values);
}

TEST(Training, GivesTheSameBitsWithOneTwoAndThreeThreads) {
  const auto data = small_data();
  TrainingConfig config = small_config(2);
  config.loss.auxiliary_thermal = 0.5F;
  config.symmetries = 2;
  const TrainingResult solo = trained(config, data);
  for (const int threads : {1, 2, 3}) {
    ThreadPool workers(threads);
    EXPECT_EQ(train(config, data, workers).model.weights, solo.model.weights) << threads;
  }
}

TEST(Training, GoesOnFromAnyEpochAsIfItHadNeverStopped) {
  const auto data = small_data();
  TrainingConfig config = small_config(4);
  config.choose_epoch = true;
  config.symmetries = 2;
  std::vector<Checkpoint> checkpoints;
  Observer observer;
  observer.epoch = [&](const EpochReport&, const Checkpoint& checkpoint) {
    checkpoints.push_back(checkpoint);
  };
  const TrainingResult whole = trained(config, data, observer);
  ASSERT_EQ(checkpoints.size(), 4U);
  for (const Checkpoint& checkpoint : checkpoints) {
    const TrainingResult rest = trained(config, data, {}, checkpoint);
    EXPECT_EQ(model::to_onnx(rest.model), model::to_onnx(whole.model)) << checkpoint.epoch;
    EXPECT_EQ(rest.epochs.size(), 4U);
    EXPECT_EQ(rest.epochs.back().loss, whole.epochs.back().loss);
  }
}

TEST(Training, KeepsTheEpochThatIsBestOnTheHeldOutAcquisition) {
  const auto data = small_data();
  TrainingConfig config = small_config(6);
  config.choose_epoch = true;
  std::vector<network::Weights> weights;
  Observer observer;
  observer.epoch = [&](const EpochReport&, const Checkpoint& checkpoint) {
    weights.push_back(checkpoint.weights);
  };
  const TrainingResult result = trained(config, data, observer);
  int best = 1;
  for (const EpochReport& report : result.epochs) {
    const double before = result.epochs[static_cast<std::size_t>(best) - 1].held_out_mse;
    EXPECT_EQ(report.kept, report.epoch == 1 || report.held_out_mse < before);
    if (report.held_out_mse < before) best = report.epoch;
  }
  EXPECT_EQ(result.model.provenance.epoch_kept, best);
  EXPECT_EQ(result.model.weights, weights[static_cast<std::size_t>(best) - 1]);
  const Fits fits = fits_of(result.model, config, data);
  ASSERT_TRUE(fits.held_out);
  EXPECT_NEAR(fits.held_out->network_mse, result.epochs[static_cast<std::size_t>(best) - 1].held_out_mse,
              1e-6);
}

TEST(Training, ChoosesTheEpochByWhatItsLossWeighs) {
  const auto data = small_data();
  TrainingConfig config = small_config(8);
  config.choose_epoch = true;
  config.loss.auxiliary_thermal = 2.0F;
  const TrainingResult result = trained(config, data);
  const auto score = [](const EpochReport& r) { return r.held_out_mse + 2.0 * r.held_out_thermal_mse; };
  const auto best =
      std::min_element(result.epochs.begin(), result.epochs.end(),
                       [&](const EpochReport& a, const EpochReport& b) { return score(a) < score(b); });
  EXPECT_EQ(result.model.provenance.epoch_kept, best->epoch);
  EXPECT_NE(best->held_out_mse, best->held_out_thermal_mse);
}

TEST(Training, NeverLooksAtTheHeldOutAcquisitionButToChooseTheEpoch) {
  auto data = small_data();
  TrainingConfig config = small_config(1);
  config.choose_epoch = true;
  const TrainingResult before = trained(config, data);
  ASSERT_EQ(before.model.provenance.held_out.size(), 1U);
  ASSERT_EQ(before.model.provenance.training.size(), 3U);
  for (Acquisition& acquisition : data)
    if (acquisition.name == before.model.provenance.held_out[0].name)
      for (float& temp_c : acquisition.temp_c) temp_c += 5.0F;
  const TrainingResult after = trained(config, data);
  EXPECT_EQ(after.model.weights, before.model.weights);
  EXPECT_EQ(after.model.scaling, before.model.scaling);
  EXPECT_NE(after.epochs[0].held_out_mse, before.epochs[0].held_out_mse);
}

TEST(Training, OtherSeedsHoldOutOtherAcquisitions) {
  const auto data = small_data();
  TrainingConfig config = small_config(1);
  config.choose_epoch = true;
  std::set<std::string> names;
  for (config.seed = 1; config.seed <= 12; ++config.seed)
    names.insert(trained(config, data).model.provenance.held_out.at(0).name);
  EXPECT_GT(names.size(), 1U);
}

TEST(Training, KeepsTheLastEpochWhereNoneIsChosen) {
  const TrainingResult result = trained(small_config(3), small_data());
  EXPECT_EQ(result.model.provenance.epoch_kept, 3);
  EXPECT_TRUE(result.model.provenance.held_out.empty());
  EXPECT_TRUE(std::isnan(result.epochs[0].held_out_mse));
}

TEST(Training, StoppedKeepsTheLastEpochThatWasFinished) {
  const auto data = small_data();
  const TrainingConfig config = small_config(5);
  int steps = 0;
  Observer observer;
  observer.stop = [&] { return ++steps > 13; };  // 6 steps an epoch: within the third
  const TrainingResult stopped = trained(config, data, observer);
  EXPECT_TRUE(stopped.stopped);
  ASSERT_EQ(stopped.epochs.size(), 2U);
  EXPECT_EQ(stopped.model.provenance.epoch_kept, 2);
  EXPECT_EQ(stopped.model.weights, trained(small_config(2), data).model.weights);
}

TEST(Training, StoppedBeforeTheFirstEpochEndedSaysSo) {
  Observer observer;
  observer.stop = [] { return true; };
  const TrainingResult result = trained(small_config(), small_data(), observer);
  EXPECT_TRUE(result.stopped);
  EXPECT_TRUE(result.epochs.empty());
  EXPECT_EQ(result.model.provenance.epoch_kept, 0);
}

TEST(Training, EndsWithARaggedBatchAndGoesThroughEveryWindow) {
  const auto data = small_data();
  TrainingConfig config = small_config(1);
  config.batch = 25;  // 176 windows: seven batches and one of a single window
  std::vector<std::size_t> steps;
  Observer observer;
  observer.step = [&](std::size_t step, std::size_t all, int, double) {
    steps.push_back(step);
    EXPECT_EQ(all, 8U);
  };
  ASSERT_EQ(network::find_windows(data, 2).size(), 176U);
  EXPECT_TRUE(std::isfinite(trained(config, data, observer).epochs[0].loss));
  EXPECT_EQ(steps, std::vector<std::size_t>{8});
}

TEST(Training, SaysWhereTheModelComesFrom) {
  auto data = small_data();
  data[1].licence = "CC-BY-4.0";
  for (Acquisition& acquisition : data) acquisition.simulated = acquisition.name == "kitchen_acq-02";
  TrainingConfig config = small_config(2);
  config.seed = 77;
  const model::Provenance provenance = trained(config, data).model.provenance;
  EXPECT_EQ(provenance.seed, 77U);
  EXPECT_EQ(provenance.epochs, 2);
  EXPECT_TRUE(provenance.simulated);
  EXPECT_EQ(provenance.data_licence, "CC-BY-4.0; not stated");
  ASSERT_EQ(provenance.training.size(), 4U);
  EXPECT_EQ(provenance.training[3].name, "kitchen_acq-02");
  EXPECT_EQ(provenance.training[3].hash, data[3].hash);
}

TEST(Training, RefusesWhatHoldsNoWindow) {
  auto data = small_data();
  for (Acquisition& acquisition : data) acquisition.run.assign(acquisition.frames(), 0);
  EXPECT_EQ(refusal([&] { trained(small_config(), data); }).code(), ExitCode::bad_usage);
  EXPECT_EQ(refusal([&] { trained(small_config(), {}); }).code(), ExitCode::bad_usage);
}

TEST(Training, RefusesToChooseTheEpochOnTheOnlyAcquisitionWithWindows) {
  auto data = small_data();
  TrainingConfig config = small_config();
  config.choose_epoch = true;
  for (std::size_t i = 1; i < data.size(); ++i) data[i].run.assign(data[i].frames(), 0);
  EXPECT_EQ(refusal([&] { trained(config, data); }).code(), ExitCode::bad_usage);
  config.choose_epoch = false;
  EXPECT_EQ(trained(config, data).epochs.size(), 3U);
}

TEST(Training, SaysInItsModelWhichLabelItLearnt) {
  auto data = small_data();
  EXPECT_EQ(trained(small_config(), data).model.provenance.label, Label::commanded);
  for (Acquisition& acquisition : data) acquisition.label = Label::shaft;
  EXPECT_EQ(trained(small_config(), data).model.provenance.label, Label::shaft);
}

TEST(Training, ThatBlowsUpSaysWhereAndWhatToTry) {
  TrainingConfig config = small_config(50);
  config.adam.rate = 1.0F;
  config.label_scale_dps = 1e-3F;
  auto data = small_data();
  for (Acquisition& acquisition : data)
    for (float& label_dps : acquisition.label_dps) label_dps *= 1e36F;
  const Error error = refusal([&] { trained(config, data); });
  EXPECT_EQ(error.code(), ExitCode::failed);
  EXPECT_NE(error.what_happened().find("step 1 of epoch 1"), std::string::npos) << error.what_happened();
  EXPECT_NE(error.advice().find("--rate"), std::string::npos);
}

TEST(Training, OfImagesAloneHasNoUseForTheGyro) {
  auto data = small_data();
  TrainingConfig config = small_config(1);
  config.shape.fusion = false;
  const TrainingResult result = trained(config, data);
  for (Acquisition& acquisition : data)
    for (float& gyro_dps : acquisition.gyro_dps) gyro_dps += 30.0F;
  EXPECT_EQ(trained(config, data).model.weights, result.model.weights);
}

TEST(Training, MirroredShowsEveryWindowWithItsSpeedNegated) {
  // A network that has only seen turns to the right knows those to the left if it trains with a mirror.
  const synthetic::AcquisitionConfig right{.rates_dps = {75.0F, 110.0F, 150.0F}};
  const synthetic::AcquisitionConfig left{.rates_dps = {-75.0F, -110.0F, -150.0F}};
  const auto data = synthetic::make_acquisitions({"garden", "kitchen"}, 2, 1, right);
  const auto other = synthetic::make_acquisitions({"garden", "kitchen"}, 2, 1, left);
  TrainingConfig config = small_config(15);
  config.shape.fusion = false;
  const auto mse_to_the_left = [&] {
    return fits_of(trained(config, data).model, config, other).training.network_mse;
  };
  const double without = mse_to_the_left();
  config.symmetries = 2;
  EXPECT_LT(4.0 * mse_to_the_left(), without);
}

TEST(Fits, ComparesTheNetworkWithTheGyroAlone) {
  auto data = small_data();
  for (Acquisition& acquisition : data)
    for (std::size_t i = 0; i < acquisition.frames(); ++i)
      acquisition.gyro_dps[i] = acquisition.label_dps[i] + 20.0F;
  const TrainingConfig config = small_config(1);
  const Fits fits = fits_of(trained(config, data).model, config, data);
  EXPECT_EQ(fits.training.windows, 176U);
  EXPECT_NEAR(fits.training.gyro_mse, 0.01, 1e-5);  // (20 / 200)^2
  EXPECT_FALSE(fits.held_out);
}

TEST(Fits, KnowsAGateThatHasCollapsed) {
  EXPECT_TRUE(gate_collapsed(0.004));
  EXPECT_TRUE(gate_collapsed(0.991));
  EXPECT_FALSE(gate_collapsed(0.4));
}

TEST(Preset, OfThePaperIsToTheLetter) {
  const TrainingConfig config = preset("paper");
  EXPECT_EQ(config.epochs, 40);
  EXPECT_EQ(config.batch, 32);
  EXPECT_EQ(config.adam.rate, 1e-3F);
  EXPECT_EQ(config.loss.berhu_fraction, 0.2F);
  EXPECT_EQ(config.loss.auxiliary_thermal, 0.0F);
  EXPECT_EQ(config.symmetries, 1);
  EXPECT_EQ(config.adam.wide_rate, 1.0F);
  EXPECT_FALSE(config.loss.likelihood || config.cosine || config.window_scaling);
  EXPECT_FALSE(config.choose_epoch);
}

TEST(Preset, IsCustomOnceAnythingDiffersFromBoth) {
  for (const char* name : {"paper", "best"}) {
    TrainingConfig config = preset(name);
    EXPECT_EQ(preset_of(config), name);
    config.shape.frames = 5;
    config.seed = 9;
    EXPECT_EQ(preset_of(config), name);
    config.epochs = 41;
    EXPECT_EQ(preset_of(config), "custom");
  }
  EXPECT_EQ(refusal([] { preset("worst"); }).code(), ExitCode::bad_usage);
}

TEST(TrainingConfig, ThatCannotBeIsRefused) {
  const auto refused = [](auto change) {
    TrainingConfig config = small_config();
    change(config);
    return refusal([&] { check(config); }).code() == ExitCode::bad_usage;
  };
  EXPECT_FALSE(refused([](TrainingConfig&) {}));
  EXPECT_TRUE(refused([](TrainingConfig& c) { c.shape.frames = 7; }));
  EXPECT_TRUE(refused([](TrainingConfig& c) { c.epochs = 0; }));
  EXPECT_TRUE(refused([](TrainingConfig& c) { c.batch = 33; }));
  EXPECT_TRUE(refused([](TrainingConfig& c) { c.batch = 0; }));
  EXPECT_TRUE(refused([](TrainingConfig& c) { c.adam.rate = nan; }));
  EXPECT_TRUE(refused([](TrainingConfig& c) { c.adam.rate = 0.0F; }));
  EXPECT_TRUE(refused([](TrainingConfig& c) { c.loss.auxiliary_thermal = -0.1F; }));
  EXPECT_TRUE(refused([](TrainingConfig& c) { c.label_scale_dps = 0.0F; }));
  EXPECT_TRUE(refused([](TrainingConfig& c) { c.symmetries = 4; }));
  EXPECT_TRUE(refused([](TrainingConfig& c) { c.made.windows = 16; }));  // not scaled by the window
}

}  // namespace
}  // namespace thermorig::training
