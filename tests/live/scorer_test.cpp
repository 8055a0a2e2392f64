// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "../support/paper_estimates.h"
#include "causal_run.h"
#include "thermorig/estimators/live/scores.h"

namespace thermorig::live {
namespace {

constexpr double frame_s = 0.125;

/// Frame `index` of one run: commanded 100 deg/s, and how far each estimate is off.
EstimateRow row(std::uint32_t index, float thermal_off = 20.0F, float gyro_off = -2.0F,
                float fusion_off = 4.0F) {
  return with_rates({.frame_index = index,
                     .time = HostTime(from_s(100.0 + index * frame_s)),
                     .rate_commanded_dps = 100.0F,
                     .run = 1,
                     .leg = 1,
                     .counted = true},
                    100.0F + gyro_off, 100.0F + thermal_off, 100.0F + fusion_off, 0.25F);
}

const EstimatorScores& of(const LiveScores& scores, PaperEstimator estimator) {
  return scores.estimators[estimator];
}

LiveScores scores_of(const std::vector<EstimateRow>& rows, double scale_dps = 200.0) {
  Scorer scorer(paper_columns, scale_dps);
  for (const EstimateRow& each : rows) scorer.add(each);
  return scorer.scores();
}

std::vector<EstimateRow> rows_of_a_run(std::uint32_t count) {
  std::vector<EstimateRow> rows;
  for (std::uint32_t i = 0; i < count; ++i) rows.push_back(row(i));
  return rows;
}

TEST(Scorer, KnowsNothingBeforeTheFirstFrame) {
  const LiveScores scores = Scorer(paper_columns).scores();
  EXPECT_EQ(scores.frames, 0U);
  EXPECT_TRUE(std::isnan(scores.gain_mean));
  EXPECT_FALSE(scores.gate_collapsed);
  for (const EstimatorScores& rate : scores.estimators) {
    EXPECT_EQ(rate.frames, 0U);
    for (const double figure : {rate.mse, rate.rmse_dps, rate.recent_median_mse, rate.recent_iqr_mse,
                                rate.angle_error_deg, rate.drift_deg_per_min})
      EXPECT_TRUE(std::isnan(figure));
  }
}

TEST(Scorer, MeansSquaredErrorsOverTheWholeRun) {
  const LiveScores scores = scores_of({row(0, 20.0F), row(1, 40.0F)});
  const EstimatorScores& thermal = of(scores, of_thermal);
  EXPECT_EQ(thermal.frames, 2U);
  EXPECT_DOUBLE_EQ(thermal.rmse_dps, std::sqrt(1000.0));
  EXPECT_DOUBLE_EQ(thermal.mse, 1000.0 / 40'000.0);
  EXPECT_DOUBLE_EQ(of(scores, of_gyro).mse, 4.0 / 40'000.0);
  EXPECT_DOUBLE_EQ(of(scores_of({row(0)}, 100.0), of_fusion).mse, 16.0 / 10'000.0);
}

TEST(Scorer, CountsFramesApartThatAreNotCounted) {
  auto rows = rows_of_a_run(3);
  rows[1] = row(1, 1000.0F, 1000.0F, 1000.0F);
  rows[1].counted = false;
  kg(rows[1]) = 0.99F;
  const LiveScores scores = scores_of(rows);
  EXPECT_EQ(scores.frames, 3U);
  EXPECT_EQ(scores.counted, 2U);
  EXPECT_EQ(scores.excluded, 1U);
  EXPECT_EQ(of(scores, of_thermal).frames, 2U);
  EXPECT_DOUBLE_EQ(of(scores, of_thermal).rmse_dps, 20.0);
  EXPECT_EQ(scores.gain_histogram[19], 0U);
}

TEST(Scorer, LeavesOutAnEstimatorThatSaysNothing) {
  auto rows = rows_of_a_run(20);
  for (EstimateRow& each : rows) fusion_dps(each) = kg(each) = unknown_dps;
  const LiveScores scores = scores_of(rows);
  EXPECT_EQ(of(scores, of_fusion).frames, 0U);
  EXPECT_TRUE(std::isnan(of(scores, of_fusion).mse));
  EXPECT_TRUE(std::isnan(of(scores, of_fusion).angle_error_deg));
  EXPECT_TRUE(std::isnan(scores.gain_mean));
  EXPECT_EQ(of(scores, of_gyro).frames, 20U);
}

TEST(Scorer, TellsMedianAndSpreadOfTheLastMinuteAlone) {
  std::vector<EstimateRow> rows;
  for (std::uint32_t i = 0; i < 1000; ++i)
    rows.push_back(row(i, i < 400 ? 500.0F : static_cast<float>(i % 3) * 10));
  const LiveScores scores = scores_of(rows);  // the last 60 s: rows 520 to 999
  const EstimatorScores& thermal = of(scores, of_thermal);
  EXPECT_EQ(thermal.frames, 1000U);
  EXPECT_EQ(thermal.recent, 480U);
  EXPECT_DOUBLE_EQ(thermal.recent_median_mse, 100.0 / 40'000.0);  // a third each of 0, 100 and 400
  EXPECT_DOUBLE_EQ(thermal.recent_iqr_mse, 400.0 / 40'000.0);
}

TEST(Scorer, InterpolatesMedianAndSpread) {
  const LiveScores scores = scores_of({row(0, 1.0F), row(1, 2.0F), row(2, 3.0F), row(3, 4.0F)}, 1.0);
  EXPECT_DOUBLE_EQ(of(scores, of_thermal).recent_median_mse, 6.5);  // of 1, 4, 9, 16
  EXPECT_DOUBLE_EQ(of(scores, of_thermal).recent_iqr_mse, 10.75 - 3.25);
}

TEST(Scorer, ForgetsTheMinuteAlsoWhileNothingIsCounted) {
  auto rows = rows_of_a_run(8);
  rows.push_back(row(600));
  rows.back().counted = false;
  const LiveScores scores = scores_of(rows);
  EXPECT_EQ(of(scores, of_gyro).recent, 0U);
  EXPECT_TRUE(std::isnan(of(scores, of_gyro).recent_median_mse));
  EXPECT_EQ(of(scores, of_gyro).frames, 8U);
}

TEST(Scorer, IntegratesAnglesOverTheTimeSinceTheFrameBefore) {
  const LiveScores scores = scores_of(rows_of_a_run(17));
  EXPECT_NEAR(scores.integrated_s, 2.0, 1e-9);
  EXPECT_NEAR(of(scores, of_thermal).angle_error_deg, 40.0, 1e-6);
  EXPECT_NEAR(of(scores, of_gyro).angle_error_deg, -4.0, 1e-6);
  EXPECT_NEAR(of(scores, of_gyro).drift_deg_per_min, -120.0, 1e-6);
}

TEST(Scorer, TellsNoDriftBeforeTheFirstSecond) {
  EXPECT_TRUE(std::isnan(of(scores_of(rows_of_a_run(8)), of_gyro).drift_deg_per_min));
  EXPECT_FALSE(std::isnan(of(scores_of(rows_of_a_run(10)), of_gyro).drift_deg_per_min));
}

TEST(Scorer, IntegratesNothingAcrossAGapOrAnotherRun) {
  const LiveScores gap = scores_of({row(0), row(5)});
  EXPECT_EQ(gap.integrated_s, 0.0);
  auto other_run = row(1);
  other_run.run = 2;
  EXPECT_EQ(scores_of({row(0), other_run}).integrated_s, 0.0);
  auto window_begins = row(0);
  window_begins.counted = false;  // of the same run: the next window stands for the time since it
  EXPECT_NEAR(scores_of({window_begins, row(1)}).integrated_s, frame_s, 1e-9);
}

TEST(Scorer, PutsGainsIntoBinsOfATwentieth) {
  auto rows = rows_of_a_run(4);
  kg(rows[0]) = 0.0F;
  kg(rows[1]) = 0.051F;
  kg(rows[2]) = 1.0F;
  kg(rows[3]) = 5.0F;  // no gain
  const LiveScores scores = scores_of(rows);
  EXPECT_EQ(scores.gain_histogram[0], 1U);
  EXPECT_EQ(scores.gain_histogram[1], 1U);
  EXPECT_EQ(scores.gain_histogram[19], 1U);
  EXPECT_NEAR(scores.gain_mean, 1.051 / 3, 1e-6);
}

TEST(Scorer, SeesAGateCollapseWhenItHasStayedOnOneSide) {
  for (const float gain : {0.01F, 0.99F}) {
    auto rows = rows_of_a_run(64);
    for (EstimateRow& each : rows) kg(each) = gain;
    EXPECT_TRUE(scores_of(rows).gate_collapsed);
    kg(rows[40]) = 0.5F;
    EXPECT_FALSE(scores_of(rows).gate_collapsed);
    kg(rows[40]) = 1.0F - gain;
    EXPECT_FALSE(scores_of(rows).gate_collapsed);
    rows.pop_back();
    kg(rows[40]) = gain;
    EXPECT_FALSE(scores_of(rows).gate_collapsed);
  }
}

TEST(Scorer, TakesRowsOfAnyTimes) {
  const auto at = [](std::uint32_t index, std::int64_t ns) {
    EstimateRow each = row(index);
    each.time = host_time_ns(ns);
    return each;
  };
  constexpr std::int64_t first = std::numeric_limits<std::int64_t>::min(),
                         last = std::numeric_limits<std::int64_t>::max();
  const LiveScores scores = scores_of({at(0, first), at(1, last), at(2, first), at(3, 0)});
  EXPECT_EQ(scores.counted, 4U);
  EXPECT_TRUE(std::isfinite(scores.integrated_s));
}

TEST(Scorer, HoldsNoMoreAfterADayThanAfterAnHour) {
  Scorer scorer(paper_columns);
  std::uint32_t index = 0;
  const auto run_for = [&](double seconds) {
    for (; index * frame_s < seconds; ++index) scorer.add(row(index, static_cast<float>(index % 50)));
  };
  run_for(3600.0);
  EXPECT_EQ(of(scorer.scores(), of_thermal).recent, 480U);
  run_for(86'400.0);
  EXPECT_EQ(of(scorer.scores(), of_thermal).recent, 480U);
}

/// A figure that is NaN in both is the same.
void expect_same(const EstimatorScores& a, const EstimatorScores& b) {
  const auto figures = [](const EstimatorScores& s) {
    return std::array{
        s.mse, s.rmse_dps, s.recent_median_mse, s.recent_iqr_mse, s.angle_error_deg, s.drift_deg_per_min};
  };
  EXPECT_EQ(a.frames, b.frames);
  EXPECT_EQ(a.recent, b.recent);
  EXPECT_EQ(std::memcmp(figures(a).data(), figures(b).data(), sizeof figures(a)), 0);
}

TEST(Scorer, GivesTheFiguresOfARunFromItsRows) {
  const auto measurements = measurements_of(two_legs());
  const auto rows =
      rows_of(measurements, model_for(acquisition_of(measurements), {.frames = 3, .reduction = 2}));
  Scorer during(paper_columns, 150.0);
  for (const EstimateRow& each : rows) {
    during.add(each);
    during.scores();  // looking changes nothing
  }
  const LiveScores live = during.scores(), stored = scores_of(rows, 150.0);
  for (std::size_t i = 0; i < live.estimators.size(); ++i)
    expect_same(live.estimators[i], stored.estimators[i]);
  EXPECT_EQ(live.gain_histogram, stored.gain_histogram);
  EXPECT_EQ(live.gain_mean, stored.gain_mean);
  EXPECT_GT(live.counted, 30U);
  EXPECT_GT(live.integrated_s, 3.0);
}

}  // namespace
}  // namespace thermorig::live
