// SPDX-License-Identifier: MIT
#include "thermorig/learning/training/prediction.h"

#include <gtest/gtest.h>

#include "thermorig/network/estimator.h"
#include "trained.h"

namespace thermorig::training {
namespace {

class Prediction : public testing::Test {
 protected:
  std::vector<network::Acquisition> data_ = small_data();
  model::Model model_{.weights = network::initial_weights({.frames = 2, .reduction = 3}, 4),
                      .scaling = network::scaling_of(small_data(), 150.0F)};
};

TEST_F(Prediction, SaysOfEachWindowWhatTheEstimatorSays) {
  const auto windows = network::find_windows(data_, 2);
  const auto estimates = predict(model_, data_, windows);
  ASSERT_EQ(estimates.size(), windows.size());
  network::Estimator estimator(model_.weights);
  for (std::size_t i = 0; i < windows.size(); i += 13) {
    const network::Acquisition& acquisition = data_[windows[i].acquisition];
    const auto frames = network::prepare(acquisition, model_.weights.shape, model_.scaling);
    const network::WindowRates rates = network::rates_of(acquisition, windows[i], 2);
    const std::size_t size = model_.weights.shape.pixels();
    const network::Output output = estimator.estimate(
        std::span(frames).subspan((windows[i].last - 1) * size, 2 * size), rates.gyro_dps / 150.0F);
    EXPECT_EQ(estimates[i].window, windows[i]);
    EXPECT_EQ(estimates[i].label_dps, rates.label_dps);
    EXPECT_EQ(estimates[i].gyro_dps, rates.gyro_dps);
    EXPECT_NEAR(estimates[i].fusion_dps, 150.0F * output.fusion, 0.01F);
    EXPECT_NEAR(estimates[i].thermal_dps, 150.0F * output.thermal, 0.01F);
    EXPECT_NEAR(estimates[i].gain, output.gain, 1e-4F);
  }
}

TEST_F(Prediction, OfAThermalOnlyModelHasOneSpeed) {
  model_.weights = network::initial_weights({.frames = 2, .reduction = 3, .fusion = false}, 4);
  for (const WindowEstimate& estimate : predict(model_, data_, network::find_windows(data_, 2))) {
    EXPECT_EQ(estimate.fusion_dps, estimate.thermal_dps);
    EXPECT_EQ(estimate.gain, 1.0F);
  }
}

TEST_F(Prediction, OfNoWindowIsNothing) {
  EXPECT_TRUE(predict(model_, data_, {}).empty());
  EXPECT_TRUE(predict(model_, {}, {}).empty());
}

TEST_F(Prediction, KeepsTheOrderOfTheWindowsThatItIsGiven) {
  const std::vector<network::Window> order{{3, 20}, {0, 5}, {3, 4}};
  const auto estimates = predict(model_, data_, order);
  for (std::size_t i = 0; i < order.size(); ++i) EXPECT_EQ(estimates[i].window, order[i]);
}

}  // namespace
}  // namespace thermorig::training
