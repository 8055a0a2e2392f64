// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "made_results.h"
#include "thermorig/core/error.h"
#include "thermorig/learning/report/report.h"

namespace thermorig::tests {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

void erase_jobs(std::vector<study::JobResult>& results, const auto& which) {
  std::erase_if(results, [&](const study::JobResult& result) { return which(result.job); });
}

TEST(StudyTables, HaveThePapersLayoutWithItsFiguresBesideOurs) {
  const std::string text = report::study_markdown(made_study());
  // Fold k of fusion has 0.005 k / 3.5: the median is 0.005, the quartiles are at k = 2.25 and 4.75.
  EXPECT_THAT(text,
              HasSubstr("| 3 | 0.005 | 0.005 | 0.004 | 0.005 | 0.0100 (20.0) | 0.0050 (14.1) | 0.0071 | "
                        "0.0036 | 6 of 6 |"));
  EXPECT_THAT(text,
              HasSubstr("| 6 | 0.008 | 0.009 | 0.018 | 0.005 | 0.0250 (31.6) | 0.0125 (22.4) | 0.0179 | "
                        "0.0089 | 6 of 6 |"));
  EXPECT_THAT(text,
              HasSubstr("| 2 | 0.013 | 0.010 | 0.005 | 0.003 | 0.0200 (28.3) | 0.0100 (20.0) | 0.0143 | "
                        "0.0071 | 6 of 6 |"));
  EXPECT_THAT(text, HasSubstr("paper, real data: median fusion | "));
  EXPECT_THAT(text, HasSubstr("ours, SIMULATED rig: median fusion"));
}

TEST(StudyTables, HoldRowsOfAllThatNeedNoNetwork) {
  const std::string text = report::study_markdown(made_study());
  EXPECT_THAT(text, HasSubstr("| gyro (Nf = 3) | - | - | - | - | 0.0200 (28.3) | 0.0200 (28.3) | 0.0000 |"));
  EXPECT_THAT(text, HasSubstr("| gyro-rest (Nf = 3) | - | - | - | - | 0.00050 (4.5) |"));
  EXPECT_THAT(text, Not(HasSubstr("gyro-kalman")));  // which says nothing in these results
}

TEST(StudyTables, StateTheUnitAndThatThePapersIsAssumed) {
  const std::string text = report::study_markdown(made_study());
  EXPECT_THAT(text, HasSubstr("(speed / 200 deg/s)^2, so 0.01 is an RMSE of 20 deg/s"));
  EXPECT_THAT(text, HasSubstr("that it is the same is an assumption"));
}

TEST(StudyTables, CallDataSimulatedOnlyWhereTheyAre) {
  auto results = made_study();
  EXPECT_THAT(report::study_markdown(results),
              HasSubstr("SIMULATED: these data come from the simulated rig"));
  for (auto& result : results) result.simulated = false;
  const std::string text = report::study_markdown(results);
  EXPECT_THAT(text, Not(HasSubstr("SIMULATED")));
  EXPECT_THAT(text, HasSubstr("ours, real data: median fusion"));
}

TEST(StudyTables, NameEachInstructionSetOfAMixture) {
  auto results = made_study();
  EXPECT_THAT(report::study_markdown(results), HasSubstr("| instruction set | avx2 |"));
  EXPECT_THAT(report::study_markdown(results), Not(HasSubstr("more than one instruction set")));
  results[3].instruction_set = "avx512";
  const std::string text = report::study_markdown(results);
  EXPECT_THAT(text, HasSubstr("| avx2 (107 results), avx512 (1 result) |"));
  EXPECT_THAT(text, HasSubstr("more than one instruction set"));
}

TEST(StudyTables, TakeThermalOnlyFromItsOwnNetwork) {
  // The fused network's own thermal head is ten times worse in these results.
  const std::string text = report::study_markdown(made_study());
  EXPECT_THAT(text, HasSubstr("| cnn-thermal | 0.0150 (24.5), IQR"));
}

TEST(StudyTables, ShowWhatIsMissing) {
  auto results = made_study();
  erase_jobs(results,
             [](const study::Job& job) { return job.frames == 4 && job.fusion && job.test >= "garden-5"; });
  erase_jobs(results, [](const study::Job& job) { return job.frames == 5 && !job.fusion; });
  erase_jobs(results, [](const study::Job& job) { return job.reduction == 2; });
  const std::string text = report::study_markdown(results);
  EXPECT_THAT(text, HasSubstr("Nf = 4, Nr = 1, fusion: 4 of 6 folds"));
  EXPECT_THAT(text, HasSubstr("Nf = 5, Nr = 1, thermal-only: no result"));
  // Folds 1 to 4 at Nf = 4: the median is 0.0075 * 2.5 / 3.5.
  EXPECT_THAT(text, HasSubstr("| 0.0150 (24.5) | 0.0054 (14.6) | 0.0107 | 0.0032 | 6 / 4 of 6 |"));
  EXPECT_THAT(text, HasSubstr("| 2 | 0.013 | 0.010 | 0.005 | 0.003 | no result | no result | no result | "
                              "no result | 0 of 6 |"));
  EXPECT_THAT(text, HasSubstr("Not every setting has all its folds."));
}

TEST(StudyTables, SayWhenNothingIsMissing) {
  EXPECT_THAT(report::study_markdown(made_study()), HasSubstr("has all its folds"));
}

TEST(StudyTables, AreDrawnOfASingleResult) {
  const std::vector<study::JobResult> one{made_result({.fusion = false})};
  const std::string text = report::study_markdown(one);
  EXPECT_THAT(text, HasSubstr("| 0.0100 (20.0) | no result | - | no result | 1 / 0 of 1 |"));
  EXPECT_THAT(text, HasSubstr("No result of fusion, so no gate."));
}

TEST(StudyTables, SayWhereTheGateHasCollapsed) {
  const std::vector<study::JobResult> closed{made_result({.gain = 0.001})};
  EXPECT_THAT(report::study_markdown(closed), HasSubstr("| 100 % | 0 % | 0.025 | collapsed to 0 |"));
  const std::vector<study::JobResult> open{made_result({.gain = 0.999})};
  EXPECT_THAT(report::study_markdown(open), HasSubstr("| 0 % | 100 % | 0.975 | collapsed to 1 |"));
  EXPECT_THAT(report::study_markdown(made_study()), Not(HasSubstr("collapsed")));
}

TEST(StudyTables, ShowTheDriftOfAllEstimators) {
  const std::string text = report::study_markdown(made_study());
  EXPECT_THAT(text, HasSubstr("| garden-1 | 2.0 (2.0) | 1.0 (1.0) | -60.0 (60.0) | 0.10 (0.1) |"));
  EXPECT_THAT(text, HasSubstr("(worst of all) | 2.0 (2.0) | 1.0 (1.0) | 60.0 (60.0) | 0.10 (0.1) |"));
}

TEST(StudyTables, CountWindowsBySpeedOverAllFolds) {
  // 40 windows a speed and fold.
  const std::string text = report::study_markdown(made_study());
  EXPECT_THAT(text, HasSubstr("| 20 | 240 | 240 | "));
  EXPECT_THAT(text, HasSubstr("960 test windows at 4 speeds"));
}

TEST(StudyTables, ShowTheSpreadOverSeeds) {
  const std::string text = report::study_markdown(made_study(1.1));
  EXPECT_THAT(text, HasSubstr("| 2 | 0.0110 (21.0) | 0.0079 | 6 of 6 | 0.0055 (14.8) | 0.0039 | 6 of 6 |"));
}

TEST(StudyTables, DoNotDependOnTheOrderOfResultsNorCountOneTwice) {
  const auto results = made_study();
  auto shuffled = results;
  std::reverse(shuffled.begin(), shuffled.end());
  shuffled.push_back(results[3]);
  EXPECT_EQ(report::study_markdown(shuffled), report::study_markdown(results));
  EXPECT_EQ(report::study_json(shuffled), report::study_json(results));
  EXPECT_EQ(report::study_html(shuffled), report::study_html(results));
}

TEST(StudyTables, NeverMixStudiesOfOtherEpochsOrData) {
  std::vector<study::JobResult> results{made_result({.mse = 0.01}), made_result({.mse = 0.04})};
  results[1].job.epochs = 1;
  const std::string text = report::study_markdown(results);
  EXPECT_THAT(text, HasSubstr("The results are of 2 studies"));
  EXPECT_THAT(text, HasSubstr("1 epochs, data 01234567): Frames of a window"));
  EXPECT_THAT(text, HasSubstr("0.0100 (20.0)"));
  EXPECT_THAT(text, HasSubstr("0.0400 (40.0)"));
}

TEST(StudyTables, RefuseNoResultsAtAll) {
  for (const auto report : {report::study_markdown, report::study_json, report::study_html}) {
    try {
      report({});
      FAIL() << "a report of nothing";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::bad_usage);
      EXPECT_THAT(error.what_happened(), HasSubstr("no result"));
    }
  }
}

TEST(StudyTables, KeepHostileNamesInTheirCells) {
  const std::vector<study::JobResult> results{made_result({.fold = "a|b\n# <b>c</b> [d](e) `f` \xff\x01"})};
  const std::string text = report::study_markdown(results);
  EXPECT_THAT(text, HasSubstr("a\\|b \\# \\<b\\>c\\</b\\> \\[d\\](e) \\`f\\` \xef\xbf\xbd"));
  EXPECT_THAT(text, Not(HasSubstr("\n# <b>")));
  EXPECT_THAT(text, Not(HasSubstr("\xff")));
}

}  // namespace
}  // namespace thermorig::tests
