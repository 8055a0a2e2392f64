// SPDX-License-Identifier: MIT
#include "thermorig/learning/study/evaluation.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "../support/synthetic_acquisitions.h"
#include "estimates_of.h"
#include "learning/study/gain_statistics.h"
#include "thermorig/estimators/table.h"
#include "thermorig/learning/training/prediction.h"

namespace thermorig::study {
namespace {

Evaluation evaluated(const std::vector<JudgedWindow>& estimates, const network::Acquisition& acquisition,
                     const EvaluationConfig& config = {}) {
  return evaluate(estimates, std::span(&acquisition, 1), config);
}

TEST(Evaluation, GivesTheErrorsOfEachEstimator) {
  const network::Acquisition acquisition = plain_acquisition("a", 10, 100.0F);
  const Evaluation evaluation =
      evaluated({judged(2, 100, 10, -2, 40), judged(3, 100, -30, 4, 40)}, acquisition);
  const Errors& thermal = evaluation.errors[thermal_name];
  EXPECT_EQ(thermal.windows, 2U);
  EXPECT_DOUBLE_EQ(thermal.mse, 500.0 / 40'000.0);
  EXPECT_DOUBLE_EQ(thermal.rmse_dps, std::sqrt(500.0));
  EXPECT_DOUBLE_EQ(thermal.median_dps, 20.0);
  EXPECT_DOUBLE_EQ(thermal.p95_dps, 29.0);
  EXPECT_DOUBLE_EQ(thermal.mean_error_dps, -10.0);
  EXPECT_DOUBLE_EQ(thermal.outlier_share, 0.0);  // 30 deg/s is none yet
  EXPECT_DOUBLE_EQ(evaluation.errors[fusion_name].mse, 10.0 / 40'000.0);
  EXPECT_DOUBLE_EQ(evaluation.errors[gyro_name].outlier_share, 1.0);
}

TEST(Evaluation, NormalisesByTheLabelScale) {
  const network::Acquisition acquisition = plain_acquisition("a", 10, 100.0F);
  const Evaluation evaluation = evaluated({judged(2, 100, 10, 0, 0)}, acquisition, {.label_scale_dps = 10.0});
  EXPECT_DOUBLE_EQ(evaluation.errors[thermal_name].mse, 1.0);
  EXPECT_DOUBLE_EQ(evaluation.errors[thermal_name].rmse_dps, 10.0);
}

TEST(Evaluation, ComparesEveryEstimatorOfTheTableThatNeedsNoNetwork) {
  std::vector<std::string> names{"cnn-thermal", "cnn-fusion", "cnn-fusion-kalman"};
  for (const estimators::Entry& entry : estimators::all_entries())
    if (!entry.needs_network) names.emplace_back(entry.name);
  const auto compared = all_estimators();
  EXPECT_EQ(std::vector(compared.begin(), compared.end()), names);
  EXPECT_EQ(baselines().front(), "gyro");
}

TEST(Evaluation, SaysUnknownOfAnEstimatorThatSaysNothing) {
  const network::Acquisition acquisition = plain_acquisition("a", 10, 100.0F);
  const Evaluation evaluation = evaluated({judged(2, 100, 0, 0, 8), judged(3, 100, 0, 0, 6)}, acquisition);
  const Errors& rest = evaluation.errors["gyro-rest"];
  EXPECT_EQ(rest.windows, 0U);
  EXPECT_TRUE(std::isnan(rest.mse) && std::isnan(rest.p95_dps) && std::isnan(rest.mean_error_dps));
  EXPECT_TRUE(std::isnan(evaluation.speeds.at(0).mse["gyro-rest"]));
  EXPECT_TRUE(evaluation.angles.at(0).error_deg["gyro-rest"].empty());
  EXPECT_EQ(evaluation.errors[gyro_name].windows, 2U);
}

TEST(Evaluation, LeavesWindowsWithoutAGyroOutOfWhatNeedsOne) {
  const network::Acquisition acquisition = plain_acquisition("a", 10, 100.0F);
  const Evaluation evaluation =
      evaluated({judged(2, 100, 5, nan, nan, nan), judged(3, 100, 5, 1, 2)}, acquisition);
  EXPECT_EQ(evaluation.errors[thermal_name].windows, 2U);
  EXPECT_EQ(evaluation.errors[fusion_name].windows, 1U);
  EXPECT_EQ(evaluation.errors[gyro_name].windows, 1U);
  EXPECT_DOUBLE_EQ(evaluation.errors[gyro_name].rmse_dps, 2.0);
  EXPECT_EQ(evaluation.gain.windows(), 1U);
}

TEST(Evaluation, LeavesWindowsWithoutALabelOut) {
  const network::Acquisition acquisition = plain_acquisition("a", 10, 100.0F);
  const Evaluation evaluation = evaluated({judged(2, nan, 5, 1, 2), judged(3, 100, 5, 1, 2)}, acquisition);
  EXPECT_EQ(evaluation.errors[thermal_name].windows, 1U);
  EXPECT_EQ(evaluation.speeds.at(0).windows, 1U);
}

TEST(JudgedWindows, HoldMeansOverTheirFrames) {
  network::Acquisition acquisition = plain_acquisition("a", 4, 100.0F);
  acquisition.label_dps = {10, 20, 40, 80};
  acquisition.rates = {{"gyro", {1, 2, 4, 8}}, {"gyro-rest", {nan, 2, 4, 8}}};
  const std::vector<network::Window> windows{{0, 1}, {0, 3}};
  const std::vector<JudgedWindow> judged = judged_windows(std::span(&acquisition, 1), windows, 2);
  ASSERT_EQ(judged.size(), 2U);
  EXPECT_EQ(judged[1].window, windows[1]);
  EXPECT_EQ(judged[1].label_dps, 60.0F);
  EXPECT_EQ(judged[1].rate_dps["gyro"], 6.0F);
  EXPECT_EQ(judged[0].rate_dps["gyro"], 1.5F);
  EXPECT_TRUE(std::isnan(judged[0].rate_dps["gyro-rest"]));  // of one of its frames it says nothing
  EXPECT_EQ(judged[1].rate_dps["gyro-rest"], 6.0F);
  EXPECT_TRUE(std::isnan(judged[1].rate_dps["gyro-kalman"]) && std::isnan(judged[1].rate_dps[thermal_name]));
}

TEST(Evaluation, HoldsEstimatesAgainstTheShaftAsWell) {
  network::Acquisition acquisition = plain_acquisition("a", 4, 100.0F);
  acquisition.shaft_dps = {97, 97, 97, nan};
  acquisition.rates = {{"gyro", {98, 98, 98, 98}}};
  const std::vector<network::Window> windows{{0, 1}, {0, 2}, {0, 3}};
  const auto judged = judged_windows(std::span(&acquisition, 1), windows, 2);
  const Evaluation evaluation = evaluate(judged, std::span(&acquisition, 1));
  EXPECT_DOUBLE_EQ(evaluation.errors[gyro_name].mean_error_dps, -2.0);
  EXPECT_EQ(evaluation.errors[gyro_name].windows, 3U);
  EXPECT_DOUBLE_EQ(evaluation.shaft_errors[gyro_name].mean_error_dps, 1.0);
  EXPECT_EQ(evaluation.shaft_errors[gyro_name].windows, 2U);  // of one of its frames nothing is known
}

TEST(JudgedWindows, HoldTheMeanOfTheLongestLooksThatLieWithinThem) {
  network::Acquisition acquisition = plain_acquisition("a", 6, 100.0F);
  acquisition.rates = {{"gyro", {1, 2, 3, 4, 5, 6}, 1}, {"gyro", {nan, nan, 30, 40, 50, 70}, 3}};
  const std::vector<network::Window> windows{{0, 5}};
  const auto rate = [&](int frames) {
    return judged_windows(std::span(&acquisition, 1), windows, frames).front().rate_dps["gyro"];
  };
  EXPECT_EQ(rate(2), 5.5F);   // shorter than a look: frame by frame
  EXPECT_EQ(rate(3), 70.0F);  // one look
  EXPECT_EQ(rate(4), 60.0F);  // two
}

TEST(Evaluation, GivesErrorsInUnitsOfTheBounds) {
  const network::Acquisition acquisition = plain_acquisition("a", 10, 100.0F);
  std::vector<JudgedWindow> windows{judged(2, 100, 2, 3, 0), judged(3, 100, -2, 3, 0),
                                    judged(4, 100, 8, 3, 0), judged(5, 100, 50, 3, 0)};
  EXPECT_FALSE(evaluated(windows, acquisition).bounds);
  windows[0].bound_dps = windows[1].bound_dps = 1.0F;
  windows[2].bound_dps = 4.0F;  // the last one has none
  const auto bounds = evaluated(windows, acquisition).bounds;
  ASSERT_TRUE(bounds);
  EXPECT_EQ(bounds->windows, 3U);
  EXPECT_EQ(bounds->well_told, 2U);
  EXPECT_DOUBLE_EQ(bounds->median_dps, 1.0);
  EXPECT_DOUBLE_EQ(bounds->well_told_rmse[thermal_name], 2.0);
  EXPECT_NEAR(bounds->median[thermal_name], 2.0 / 0.67449, 1e-3);
  EXPECT_TRUE(std::isnan(bounds->median["gyro-rest"]) && std::isnan(bounds->well_told_rmse["gyro-rest"]));
}

TEST(GateSigma, IsHeldAgainstTheErrorsOfTheImagesAgainstTheShaft) {
  std::vector<JudgedWindow> windows(4);
  const std::array<float, 4> errors_dps{0.0F, 4.0F, -8.0F, 30.0F};
  for (std::size_t i = 0; i < windows.size(); ++i) {
    windows[i].shaft_dps = 50.0F;
    windows[i].rate_dps[thermal_name] = 50.0F + errors_dps[i];
    windows[i].gain = 0.8F;
    windows[i].sigma_dps = 5.0F;
  }
  windows.push_back({});  // of a gate that states nothing
  const auto sigma = gate_sigma(windows);
  ASSERT_TRUE(sigma);
  EXPECT_EQ(sigma->windows, 4U);
  EXPECT_EQ(sigma->median_dps, 5.0);
  EXPECT_EQ(sigma->within_one, 0.5);
  EXPECT_EQ(sigma->within_two, 0.75);
  // 0.8 of the images' error and 0.2 of a gyro's 10 deg/s.
  EXPECT_NEAR(sigma->fusion_rmse_dps, std::sqrt(0.64 * (16.0 + 64.0 + 900.0) / 4.0 + 4.0), 1e-4);
  EXPECT_FALSE(gate_sigma(std::vector<JudgedWindow>(3)));
}

TEST(JudgedWindows, SayWhatAModelPredicts) {
  const std::vector<network::Acquisition> acquisitions = synthetic::make_acquisitions({"garden"}, 1, 1);
  for (const bool fusion : {true, false}) {
    model::Model model;
    model.weights = network::initial_weights({.frames = 2, .reduction = 3, .fusion = fusion}, 1);
    const auto windows = network::find_windows(acquisitions, 2);
    const auto judged = judged_windows(model, acquisitions, windows);
    const auto predicted = training::predict(model, acquisitions, windows);
    ASSERT_EQ(judged.size(), windows.size());
    EXPECT_EQ(judged[7].rate_dps[thermal_name], predicted[7].thermal_dps);
    EXPECT_EQ(judged[7].rate_dps[gyro_name], predicted[7].gyro_dps);
    EXPECT_EQ(judged[7].label_dps, predicted[7].label_dps);
    if (fusion) {
      EXPECT_EQ(judged[7].rate_dps[fusion_name], predicted[7].fusion_dps);
      EXPECT_EQ(judged[7].gain, predicted[7].gain);
    }
    const Evaluation evaluation = evaluate(judged, acquisitions);
    EXPECT_EQ(evaluation.errors[fusion_name].windows, fusion ? windows.size() : 0U);
    EXPECT_EQ(evaluation.gain.windows(), fusion ? windows.size() : 0U);
  }
}

TEST(Evaluation, OfNoWindowsIsUnknown) {
  const network::Acquisition acquisition = plain_acquisition("a", 10, 100.0F);
  const Evaluation evaluation = evaluated({}, acquisition);
  for (const Errors& errors : evaluation.errors.values()) {
    EXPECT_EQ(errors.windows, 0U);
    EXPECT_TRUE(std::isnan(errors.mse));
  }
  EXPECT_TRUE(evaluation.speeds.empty());
  EXPECT_DOUBLE_EQ(evaluation.angles.at(0).integrated_s, 0.0);
}

TEST(Evaluation, DividesByCommandedSpeedWithItsSign) {
  network::Acquisition acquisition = plain_acquisition("a", 10, 100.0F);
  acquisition.leg_rate_dps = {50, 50, 50, 50, -50, -50, -50, 20, 20, 20};
  const Evaluation evaluation = evaluated(
      {judged(3, 50, 20, 0, 0), judged(5, -50, 40, 0, 0), judged(6, -50, -40, 0, 0), judged(9, 20, 0, 0, 0)},
      acquisition);
  ASSERT_EQ(evaluation.speeds.size(), 3U);
  EXPECT_DOUBLE_EQ(evaluation.speeds[0].rate_dps, -50.0);
  EXPECT_EQ(evaluation.speeds[0].windows, 2U);
  EXPECT_DOUBLE_EQ(evaluation.speeds[0].mse[thermal_name], 0.04);
  EXPECT_DOUBLE_EQ(evaluation.speeds[1].rate_dps, 20.0);
  EXPECT_DOUBLE_EQ(evaluation.speeds[2].mse[thermal_name], 0.01);
}

TEST(Evaluation, TellsTheEnvironmentsApart) {
  std::vector<network::Acquisition> acquisitions{plain_acquisition("a", 10, 100.0F),
                                                 plain_acquisition("b", 10, 100.0F),
                                                 plain_acquisition("c", 10, 100.0F)};
  acquisitions[0].environment = acquisitions[2].environment = "kitchen";
  acquisitions[2].simulated = true;
  std::vector<JudgedWindow> estimates{judged(4, 100, 10, 0, 0), judged(4, 100, 20, 0, 0)};
  estimates[1].window.acquisition = 1;
  const Evaluation evaluation = evaluate(estimates, acquisitions);
  ASSERT_EQ(evaluation.environments.size(), 2U);
  EXPECT_EQ(evaluation.environments[0].name, "garden");
  EXPECT_EQ(evaluation.environments[0].acquisitions, 1U);
  EXPECT_DOUBLE_EQ(evaluation.environments[0].errors[thermal_name].rmse_dps, 20.0);
  EXPECT_EQ(evaluation.environments[1].acquisitions, 2U);
  EXPECT_DOUBLE_EQ(evaluation.environments[1].errors[thermal_name].rmse_dps, 10.0);
  EXPECT_TRUE(evaluation.simulated);
}

TEST(Evaluation, HasAnAngleForEachAcquisition) {
  const std::vector<network::Acquisition> acquisitions{plain_acquisition("a", 10, 100.0F),
                                                       plain_acquisition("b", 10, 100.0F)};
  std::vector<JudgedWindow> estimates{judged(4, 100, 0, 0, 5), judged(4, 100, 0, 0, -3)};
  estimates[1].window.acquisition = 1;
  const Evaluation evaluation = evaluate(estimates, acquisitions);
  EXPECT_EQ(evaluation.names, (std::vector<std::string>{"a", "b"}));
  EXPECT_DOUBLE_EQ(evaluation.angles.at(0).worst_deg[gyro_name], 0.5);
  EXPECT_DOUBLE_EQ(evaluation.angles.at(1).worst_deg[gyro_name], 0.3);
}

}  // namespace
}  // namespace thermorig::study
