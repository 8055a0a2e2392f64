// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "made_results.h"
#include "thermorig/learning/report/report.h"

namespace thermorig::tests {
namespace {

using ::testing::HasSubstr;

std::string field_of(const std::vector<study::JobResult>& results, const std::string& key,
                     const std::string& field) {
  const auto report = nlohmann::json::parse(report::study_json(results));
  for (const auto& claim : report["studies"][0]["claims"])
    if (claim["key"] == key) return claim[field];
  return "no such claim";
}

std::string verdict_of(const std::vector<study::JobResult>& results, const std::string& key) {
  return field_of(results, key, "verdict");
}

/// Changes the MSE of every job's own estimator.
void scale_mse(std::vector<study::JobResult>& results, const auto& factor_of) {
  for (auto& result : results) {
    auto& errors = result.evaluation.errors[result.job.fusion ? study::fusion_name : study::thermal_name];
    errors.mse *= factor_of(result.job);
    errors.rmse_dps = 200.0 * std::sqrt(errors.mse);
  }
}

TEST(Claims, HoldWhereTheNumbersSaySo) {
  const auto results = made_study();
  for (const char* key :
       {"lower_median", "smaller_spread", "grows_with_reduction_thermal", "grows_with_reduction_fusion",
        "three_frames_best_thermal", "three_frames_best_fusion", "drift", "gain_peak", "beats_gyro"})
    EXPECT_EQ(verdict_of(results, key), "holds") << key;
  EXPECT_EQ(verdict_of(results, "beats_gyro-rest"), "does not hold");
}

TEST(Claims, DoNotHoldWhereTheNumbersSayTheOpposite) {
  auto results = made_study();
  scale_mse(results, [](const study::Job& job) {
    const double order = std::pow(job.reduction, -2.0) * std::pow(1.0 + std::abs(job.frames - 3), -2.0);
    return (job.fusion ? 4.0 : 1.0) * order;
  });
  for (const char* key : {"lower_median", "smaller_spread", "grows_with_reduction_thermal",
                          "grows_with_reduction_fusion", "three_frames_best_thermal"})
    EXPECT_EQ(verdict_of(results, key), "does not hold") << key;
}

TEST(Claims, AreWithinTheSpreadOfSeedsWhereSeedsDifferMore) {
  const auto results = made_study(3.0);  // seeds differ 9 times
  for (const char* key : {"lower_median", "smaller_spread", "grows_with_reduction_thermal",
                          "three_frames_best_fusion", "grows_less_with_fusion", "beats_gyro"})
    EXPECT_EQ(verdict_of(results, key), "within the spread of seeds") << key;
}

TEST(Claims, HoldInPartWhereSomeSettingsSaySo) {
  auto results = made_study();
  scale_mse(results, [](const study::Job& job) { return job.fusion && job.frames > 4 ? 8.0 : 1.0; });
  EXPECT_EQ(verdict_of(results, "lower_median"), "holds in part");
  EXPECT_THAT(field_of(results, "lower_median", "evidence"),
              HasSubstr("lower in 5, too close in 0, higher in 2 of 7 settings"));
}

TEST(Claims, SeeAGrowthThatIsSmallerWithFusion) {
  auto results = made_study();
  scale_mse(results, [](const study::Job& job) { return job.fusion ? 1.0 / job.reduction : 1.0; });
  EXPECT_EQ(verdict_of(results, "grows_less_with_fusion"), "holds");
  EXPECT_EQ(verdict_of(results, "grows_with_reduction_fusion"), "within the spread of seeds");
}

TEST(Claims, SeeAGrowthThatIsNotStepByStep) {
  auto results = made_study();
  scale_mse(results, [](const study::Job& job) { return job.reduction == 2 ? 5.0 : 1.0; });
  EXPECT_EQ(verdict_of(results, "grows_with_reduction_thermal"), "holds in part");
}

TEST(Claims, JudgeDriftByTheGyros) {
  const auto drift = [](double fusion, double gyro) {
    return std::vector{made_result({.drift_deg_per_min = fusion, .gyro_drift_deg_per_min = gyro})};
  };
  EXPECT_EQ(verdict_of(drift(-1.0, 60.0), "drift"), "holds");
  EXPECT_EQ(verdict_of(drift(30.0, 60.0), "drift"), "holds in part");
  EXPECT_EQ(verdict_of(drift(-80.0, 60.0), "drift"), "does not hold");
  EXPECT_EQ(verdict_of(drift(60.0, 60.0), "drift"), "does not hold");
}

TEST(Claims, OfDriftAreWithinTheSpreadOfSeedsWhereSeedsDisagree) {
  EXPECT_EQ(
      verdict_of({made_result({.seed = 1}), made_result({.seed = 2, .drift_deg_per_min = 70.0})}, "drift"),
      "within the spread of seeds");
}

TEST(Claims, SeeACollapsedGate) {
  EXPECT_EQ(verdict_of({made_result({.gain = 0.001})}, "gain_peak"), "does not hold");
  EXPECT_THAT(field_of({made_result({.gain = 0.001})}, "gain_peak", "evidence"), HasSubstr("collapsed to 0"));
}

TEST(Claims, OfTheGateAreWithinTheSpreadOfSeedsWhereSeedsDisagree) {
  EXPECT_EQ(verdict_of({made_result({.seed = 1}), made_result({.seed = 2, .gain = 0.05})}, "gain_peak"),
            "within the spread of seeds");
}

TEST(Claims, CannotBeToldWithoutTheResultsTheyNeed) {
  const std::vector<study::JobResult> thermal{made_result({.fusion = false})};
  for (const char* key :
       {"lower_median", "smaller_spread", "grows_with_reduction_thermal", "grows_less_with_fusion",
        "three_frames_best_thermal", "drift", "gain_peak", "beats_gyro"})
    EXPECT_EQ(verdict_of(thermal, key), "cannot be told") << key;
}

TEST(Claims, SayThatTheSpreadOfSeedsIsNotKnownWithOneSeed) {
  EXPECT_THAT(report::study_markdown(std::vector{made_result({})}),
              HasSubstr("The spread over seeds is not known"));
  EXPECT_THAT(report::study_markdown(made_study(1.1)),
              HasSubstr("between the 3 seeds at Nf = 3, Nr = 1 (median: thermal-only 1.21, fusion 1.21"));
}

TEST(Claims, TakeTheGyrosOwnFiguresForNoGain) {
  // What a collapsed gate gives: the gyro but for rounding.
  EXPECT_EQ(verdict_of({made_result({.mse = 0.01999, .gain = 0.001})}, "beats_gyro"), "too close to tell");
}

TEST(Claims, LeaveOutSettingsThatLackFolds) {
  auto results = made_study();
  std::erase_if(results, [](const study::JobResult& result) {
    return result.job.frames == 2 && result.job.fusion && result.job.test == "garden-6";
  });
  EXPECT_THAT(field_of(results, "lower_median", "evidence"), HasSubstr("of 6 settings"));
}

TEST(Claims, SeeNoSpreadInOneFold) {
  const std::vector<study::JobResult> fold{made_result({}), made_result({.fusion = false})};
  EXPECT_EQ(verdict_of(fold, "smaller_spread"), "cannot be told");
}

}  // namespace
}  // namespace thermorig::tests
