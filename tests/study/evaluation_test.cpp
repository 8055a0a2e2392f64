// SPDX-License-Identifier: MIT
#include "thermorig/study/evaluation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "estimates_of.h"

namespace thermorig::study {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

Evaluation evaluated(const std::vector<training::WindowEstimate>& estimates,
                     const windows::Acquisition& acquisition, const EvaluationConfig& config = {}) {
  return evaluate(estimates, std::span(&acquisition, 1), config);
}

TEST(Evaluation, GivesTheErrorsOfEachEstimator) {
  const windows::Acquisition acquisition = plain_acquisition("a", 10, 100.0F);
  const Evaluation evaluation =
      evaluated({estimate(2, 100, 10, -2, 40), estimate(3, 100, -30, 4, 40)}, acquisition);
  const Errors& thermal = evaluation.errors[index(Estimator::thermal)];
  EXPECT_EQ(thermal.windows, 2U);
  EXPECT_DOUBLE_EQ(thermal.mse, 500.0 / 40'000.0);
  EXPECT_DOUBLE_EQ(thermal.rmse_dps, std::sqrt(500.0));
  EXPECT_DOUBLE_EQ(thermal.median_dps, 20.0);
  EXPECT_DOUBLE_EQ(thermal.p95_dps, 29.0);
  EXPECT_DOUBLE_EQ(thermal.bias_dps, -10.0);
  EXPECT_DOUBLE_EQ(thermal.outlier_share, 0.0);  // 30 deg/s is none yet
  EXPECT_DOUBLE_EQ(evaluation.errors[index(Estimator::fusion)].mse, 10.0 / 40'000.0);
  EXPECT_DOUBLE_EQ(evaluation.errors[index(Estimator::gyro)].outlier_share, 1.0);
}

TEST(Evaluation, NormalisesByTheLabelScale) {
  const windows::Acquisition acquisition = plain_acquisition("a", 10, 100.0F);
  const Evaluation evaluation =
      evaluated({estimate(2, 100, 10, 0, 0)}, acquisition, {.label_scale_dps = 10.0});
  EXPECT_DOUBLE_EQ(evaluation.errors[index(Estimator::thermal)].mse, 1.0);
  EXPECT_DOUBLE_EQ(evaluation.errors[index(Estimator::thermal)].rmse_dps, 10.0);
}

TEST(Evaluation, RemovesTheBiasOfTheRestFromTheGyro) {
  windows::Acquisition acquisition = plain_acquisition("a", 10, 100.0F);
  acquisition.rest_bias_dps = 7.0;
  const Evaluation evaluation =
      evaluated({estimate(2, 100, 0, 0, 8), estimate(3, 100, 0, 0, 6)}, acquisition);
  EXPECT_DOUBLE_EQ(evaluation.errors[index(Estimator::gyro)].bias_dps, 7.0);
  EXPECT_DOUBLE_EQ(evaluation.errors[index(Estimator::gyro_unbiased)].bias_dps, 0.0);
  EXPECT_DOUBLE_EQ(evaluation.errors[index(Estimator::gyro_unbiased)].rmse_dps, 1.0);
}

TEST(Evaluation, SaysUnknownWhereThereWasNoRest) {
  windows::Acquisition acquisition = plain_acquisition("a", 10, 100.0F);
  acquisition.rest_bias_dps = nan;
  const Evaluation evaluation =
      evaluated({estimate(2, 100, 0, 0, 8), estimate(3, 100, 0, 0, 6)}, acquisition);
  const Errors& unbiased = evaluation.errors[index(Estimator::gyro_unbiased)];
  EXPECT_EQ(unbiased.windows, 0U);
  EXPECT_TRUE(std::isnan(unbiased.mse) && std::isnan(unbiased.p95_dps) && std::isnan(unbiased.bias_dps));
  EXPECT_TRUE(std::isnan(evaluation.speeds.at(0).mse[index(Estimator::gyro_unbiased)]));
  EXPECT_TRUE(evaluation.angles.at(0).error_deg[index(Estimator::gyro_unbiased)].empty());
  EXPECT_EQ(evaluation.errors[index(Estimator::gyro)].windows, 2U);
}

TEST(Evaluation, LeavesWindowsWithoutAGyroOutOfWhatNeedsOne) {
  const windows::Acquisition acquisition = plain_acquisition("a", 10, 100.0F);
  const Evaluation evaluation =
      evaluated({estimate(2, 100, 5, nan, nan, nan), estimate(3, 100, 5, 1, 2)}, acquisition);
  EXPECT_EQ(evaluation.errors[index(Estimator::thermal)].windows, 2U);
  EXPECT_EQ(evaluation.errors[index(Estimator::fusion)].windows, 1U);
  EXPECT_EQ(evaluation.errors[index(Estimator::gyro)].windows, 1U);
  EXPECT_DOUBLE_EQ(evaluation.errors[index(Estimator::gyro)].rmse_dps, 2.0);
  EXPECT_EQ(evaluation.gain.windows(), 1U);
}

TEST(Evaluation, LeavesWindowsWithoutALabelOut) {
  const windows::Acquisition acquisition = plain_acquisition("a", 10, 100.0F);
  const Evaluation evaluation =
      evaluated({estimate(2, nan, 5, 1, 2), estimate(3, 100, 5, 1, 2)}, acquisition);
  EXPECT_EQ(evaluation.errors[index(Estimator::thermal)].windows, 1U);
  EXPECT_EQ(evaluation.speeds.at(0).windows, 1U);
}

TEST(Evaluation, SaysNothingOfTheFusionOfAThermalOnlyModel) {
  const windows::Acquisition acquisition = plain_acquisition("a", 10, 100.0F);
  const Evaluation evaluation = evaluated({estimate(2, 100, 5, 5, 2, 1.0F)}, acquisition, {.fusion = false});
  EXPECT_EQ(evaluation.errors[index(Estimator::thermal)].windows, 1U);
  EXPECT_EQ(evaluation.errors[index(Estimator::fusion)].windows, 0U);
  EXPECT_TRUE(std::isnan(evaluation.errors[index(Estimator::fusion)].mse));
  EXPECT_EQ(evaluation.gain.windows(), 0U);
  EXPECT_TRUE(std::isnan(evaluation.gain.mean));
  EXPECT_TRUE(evaluation.angles.at(0).error_deg[index(Estimator::fusion)].empty());
}

TEST(Evaluation, OfNoWindowsIsUnknown) {
  const windows::Acquisition acquisition = plain_acquisition("a", 10, 100.0F);
  const Evaluation evaluation = evaluated({}, acquisition);
  for (const Errors& errors : evaluation.errors) {
    EXPECT_EQ(errors.windows, 0U);
    EXPECT_TRUE(std::isnan(errors.mse));
  }
  EXPECT_TRUE(evaluation.speeds.empty());
  EXPECT_DOUBLE_EQ(evaluation.angles.at(0).integrated_s, 0.0);
}

TEST(Evaluation, DividesByCommandedSpeedWithItsSign) {
  windows::Acquisition acquisition = plain_acquisition("a", 10, 100.0F);
  acquisition.leg_rate_dps = {50, 50, 50, 50, -50, -50, -50, 20, 20, 20};
  const Evaluation evaluation = evaluated({estimate(3, 50, 20, 0, 0), estimate(5, -50, 40, 0, 0),
                                           estimate(6, -50, -40, 0, 0), estimate(9, 20, 0, 0, 0)},
                                          acquisition);
  ASSERT_EQ(evaluation.speeds.size(), 3U);
  EXPECT_DOUBLE_EQ(evaluation.speeds[0].rate_dps, -50.0);
  EXPECT_EQ(evaluation.speeds[0].windows, 2U);
  EXPECT_DOUBLE_EQ(evaluation.speeds[0].mse[index(Estimator::thermal)], 0.04);
  EXPECT_DOUBLE_EQ(evaluation.speeds[1].rate_dps, 20.0);
  EXPECT_DOUBLE_EQ(evaluation.speeds[2].mse[index(Estimator::thermal)], 0.01);
}

TEST(Evaluation, TellsTheEnvironmentsApart) {
  std::vector<windows::Acquisition> acquisitions{plain_acquisition("a", 10, 100.0F),
                                                 plain_acquisition("b", 10, 100.0F),
                                                 plain_acquisition("c", 10, 100.0F)};
  acquisitions[0].environment = acquisitions[2].environment = "kitchen";
  acquisitions[2].simulated = true;
  std::vector<training::WindowEstimate> estimates{estimate(4, 100, 10, 0, 0), estimate(4, 100, 20, 0, 0)};
  estimates[1].window.acquisition = 1;
  const Evaluation evaluation = evaluate(estimates, acquisitions, 200.0);
  ASSERT_EQ(evaluation.environments.size(), 2U);
  EXPECT_EQ(evaluation.environments[0].name, "garden");
  EXPECT_EQ(evaluation.environments[0].acquisitions, 1U);
  EXPECT_DOUBLE_EQ(evaluation.environments[0].errors[index(Estimator::thermal)].rmse_dps, 20.0);
  EXPECT_EQ(evaluation.environments[1].acquisitions, 2U);
  EXPECT_DOUBLE_EQ(evaluation.environments[1].errors[index(Estimator::thermal)].rmse_dps, 10.0);
  EXPECT_TRUE(evaluation.simulated);
}

TEST(Evaluation, JudgesEachAcquisitionByItsOwnBias) {
  std::vector<windows::Acquisition> acquisitions{plain_acquisition("a", 10, 100.0F),
                                                 plain_acquisition("b", 10, 100.0F)};
  acquisitions[0].rest_bias_dps = 5.0;
  acquisitions[1].rest_bias_dps = -3.0;
  std::vector<training::WindowEstimate> estimates{estimate(4, 100, 0, 0, 5), estimate(4, 100, 0, 0, -3)};
  estimates[1].window.acquisition = 1;
  const Evaluation evaluation = evaluate(estimates, acquisitions, 200.0);
  EXPECT_DOUBLE_EQ(evaluation.errors[index(Estimator::gyro_unbiased)].rmse_dps, 0.0);
  EXPECT_EQ(evaluation.names, (std::vector<std::string>{"a", "b"}));
  EXPECT_DOUBLE_EQ(evaluation.angles.at(1).worst_deg[index(Estimator::gyro)], 0.3);
}

}  // namespace
}  // namespace thermorig::study
