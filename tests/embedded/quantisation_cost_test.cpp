// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "quantised_model.h"
#include "support/synthetic_acquisitions.h"
#include "thermorig/learning/training/prediction.h"
#include "thermorig/learning/training/training.h"
#include "thermorig/network/embedded/c_source.h"
#include "thermorig/network/workers.h"

namespace thermorig::tests {
namespace {

using Acquisitions = std::vector<network::Acquisition>;

model::Model trained(const Acquisitions& acquisitions) {
  training::TrainingConfig config = training::preset("best");
  config.shape = {.frames = 3, .reduction = 3};
  config.choose_epoch = false;
  config.epochs = 12;
  network::CallingThread workers;
  return training::train(config, acquisitions, workers).model;
}

struct Mse {
  double thermal = 0.0, fusion = 0.0;
};

Mse mse_of(const model::Model& model, const Acquisitions& test) {
  const auto estimates =
      training::predict(model, test, network::find_windows(test, model.weights.shape.frames));
  Mse mse;
  for (const training::WindowEstimate& estimate : estimates) {
    const double thermal = estimate.thermal_dps - estimate.label_dps;
    const double fusion = estimate.fusion_dps - estimate.label_dps;
    mse.thermal += thermal * thermal / static_cast<double>(estimates.size());
    mse.fusion += fusion * fusion / static_cast<double>(estimates.size());
  }
  return mse;
}

TEST(Quantisation, RaisesTheTestErrorOfATrainedNetworkByAtMostAFewPercent) {
  const model::Model model = trained(synthetic::make_acquisitions({"laboratory", "garden"}, 3, 1));
  const Acquisitions test = synthetic::make_acquisitions({"garden"}, 2, 2);
  const Mse before = mse_of(model, test), after = mse_of(quantised(model), test);
  EXPECT_GT(before.fusion, 0.0);
  EXPECT_LE(after.fusion, 1.05 * before.fusion);
  EXPECT_LE(after.thermal, 1.05 * before.thermal);
  EXPECT_NE(after.fusion, before.fusion);
}

}  // namespace
}  // namespace thermorig::tests
