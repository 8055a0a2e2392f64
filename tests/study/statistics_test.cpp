// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "estimates_of.h"
#include "thermorig/learning/study/evaluation.h"
#include "thermorig/learning/study/study.h"

namespace thermorig::study {
namespace {

GainStatistics gains(const std::vector<float>& values) {
  const network::Acquisition acquisition = plain_acquisition("a", values.size() + 1, 60.0F);
  std::vector<JudgedWindow> estimates;
  for (std::size_t i = 0; i < values.size(); ++i)
    estimates.push_back(judged(static_cast<std::uint32_t>(i + 1), 60, 0, 0, 0, values[i]));
  return evaluate(estimates, std::span(&acquisition, 1)).gain;
}

JobResult fold(const std::string& test, const GainStatistics& gain, double mse) {
  JobResult result;
  result.job.test = test;
  result.evaluation.gain = gain;
  for (const std::string& name : all_estimators())
    result.evaluation.errors[name] = {.windows = 10, .mse = mse};
  return result;
}

// Expected values: numpy.percentile's default method.
TEST(Spread, InterpolatesBetweenOrderStatistics) {
  EXPECT_DOUBLE_EQ(spread_of({4, 1, 3, 2}).median, 2.5);
  EXPECT_DOUBLE_EQ(spread_of({4, 1, 3, 2}).iqr, 1.5);
  EXPECT_DOUBLE_EQ(spread_of({1, 2, 3, 4, 5, 60}).iqr, 2.5);
  EXPECT_DOUBLE_EQ(spread_of({7}).median, 7.0);
  EXPECT_DOUBLE_EQ(spread_of({7}).iqr, 0.0);
}

TEST(Spread, LeavesNumbersThatAreNoneOut) {
  EXPECT_DOUBLE_EQ(spread_of({1, std::nan(""), 3}).median, 2.0);
  EXPECT_TRUE(std::isnan(spread_of({}).median));
  EXPECT_TRUE(std::isnan(spread_of({std::nan("")}).iqr));
}

TEST(GainStatistics, CountsInBinsOfATwentieth) {
  const GainStatistics gain = gains({0.0F, 0.049F, 0.051F, 0.5F, 1.0F});
  EXPECT_EQ(gain.histogram[0], 2U);
  EXPECT_EQ(gain.histogram[1], 1U);
  EXPECT_EQ(gain.histogram[10], 1U);
  EXPECT_EQ(gain.histogram[19], 1U);
  EXPECT_EQ(gain.windows(), 5U);
  EXPECT_NEAR(gain.median, 0.051, 1e-7);
  EXPECT_NEAR(gain.mean, 0.32, 1e-7);
  EXPECT_DOUBLE_EQ(gain.below_002, 0.2);
  EXPECT_DOUBLE_EQ(gain.above_098, 0.2);
}

TEST(GainStatistics, TellACollapsedGate) {
  EXPECT_TRUE(collapsed(gains({0.001F, 0.0F, 0.019F})));
  EXPECT_TRUE(collapsed(gains({0.99F, 1.0F, 0.999F})));
  EXPECT_FALSE(collapsed(gains({0.001F, 0.99F, 0.5F})));
  EXPECT_FALSE(collapsed(gains({})));
}

TEST(GainStatistics, OfAllFoldsAreThoseOfAllWindows) {
  const std::vector<float> first{0.1F, 0.12F, 0.9F}, second{0.0F, 0.3F, 0.31F, 0.99F, 0.999F};
  std::vector<float> both = first;
  both.insert(both.end(), second.begin(), second.end());
  const GainStatistics all = gains(both);
  const std::vector<JobResult> folds{fold("a", gains(first), 1.0), fold("b", gains(second), 1.0)};
  const GainStatistics merged = summarise(folds).at(0).gain;
  EXPECT_EQ(merged.histogram, all.histogram);
  EXPECT_NEAR(merged.mean, all.mean, 1e-12);
  EXPECT_NEAR(merged.deviation, all.deviation, 1e-12);
  EXPECT_NEAR(merged.below_002, all.below_002, 1e-12);
  EXPECT_NEAR(merged.above_098, all.above_098, 1e-12);
  EXPECT_NEAR(merged.median, all.median, 0.05);  // within its bin
}

TEST(GainStatistics, OfCollapsedFoldsHaveAMedianWhereTheirGainsAre) {
  const auto median_of = [](const std::vector<float>& first, const std::vector<float>& second) {
    return summarise(std::vector{fold("a", gains(first), 1.0), fold("b", gains(second), 1.0)})
        .at(0)
        .gain.median;
  };
  EXPECT_LT(median_of({0.001F, 0.002F}, {0.0F, 0.03F}), 0.02);
  EXPECT_GT(median_of({0.999F, 0.985F}, {1.0F, 0.96F}), 0.98);
}

TEST(Summary, IsMedianAndSpreadOfTheFolds) {
  const std::vector<JobResult> folds{fold("c", {}, 0.04), fold("a", {}, 0.01), fold("b", {}, 0.02)};
  const std::vector<SettingSummary> rows = summarise(folds);
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].folds, 3U);
  EXPECT_EQ(rows[0].fold_mse[thermal_name], (std::vector<double>{0.01, 0.02, 0.04}));
  EXPECT_DOUBLE_EQ(rows[0].mse[thermal_name].median, 0.02);
  EXPECT_DOUBLE_EQ(rows[0].mse[thermal_name].iqr, 0.015);
  EXPECT_DOUBLE_EQ(rows[0].rmse_dps[thermal_name], 200.0 * std::sqrt(0.02));
}

TEST(Summary, PutsOnlyFoldsOfOneSettingInARow) {
  std::vector<JobResult> results(6, fold("a", {}, 0.01));
  results[1].job.frames = 2;
  results[2].job.fusion = false;
  results[3].job.seed = 2;
  results[4].job.epochs = 1;
  results[5].job.data_hash = "other";
  const std::vector<SettingSummary> rows = summarise(results);
  ASSERT_EQ(rows.size(), 6U);
  EXPECT_EQ(rows[0].frames, 2);
  EXPECT_FALSE(rows[1].fusion);
  for (const SettingSummary& row : rows) EXPECT_EQ(row.folds, 1U);
}

TEST(Summary, OfNothingHasNoRows) {
  EXPECT_TRUE(summarise({}).empty());
}

}  // namespace
}  // namespace thermorig::study
