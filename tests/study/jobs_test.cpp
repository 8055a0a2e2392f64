// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "support/synthetic_acquisitions.h"
#include "thermorig/core/error.h"
#include "thermorig/learning/study/study.h"

namespace thermorig::study {
namespace {

std::vector<network::Acquisition> small_acquisitions() {
  const synthetic::AcquisitionConfig config{.rates_dps = {50.0F}, .frames_per_leg = 6};
  return synthetic::make_acquisitions({"garden", "laboratory"}, 3, 1, config);
}

std::string refusal(const StudyConfig& config, const std::vector<network::Acquisition>& acquisitions) {
  try {
    jobs_of(config, acquisitions);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_usage);
    EXPECT_FALSE(error.advice().empty());
    return error.what_happened();
  }
  return "";
}

TEST(Jobs, OfThePaperAreItsFoldsSettingsAndSeeds) {
  const std::vector<Job> jobs = jobs_of({}, small_acquisitions());
  // 7 settings and 2 further seeds of the reference, times 3 folds and 2 set-ups.
  EXPECT_EQ(jobs.size(), 54U);
  EXPECT_EQ(std::set<Job>(jobs.begin(), jobs.end()).size(), jobs.size());
}

TEST(Jobs, BeginWithTheReferenceThenNfThenNrThenSeeds) {
  std::vector<std::vector<std::uint64_t>> order;
  for (const Job& job : jobs_of({}, small_acquisitions())) {
    const std::vector<std::uint64_t> setting{static_cast<std::uint64_t>(job.frames),
                                             static_cast<std::uint64_t>(job.reduction), job.seed};
    if (order.empty() || order.back() != setting) order.push_back(setting);
  }
  const std::vector<std::vector<std::uint64_t>> expected{
      {3, 1, 1}, {2, 1, 1}, {4, 1, 1}, {5, 1, 1}, {6, 1, 1}, {3, 2, 1}, {3, 3, 1}, {3, 1, 2}, {3, 1, 3}};
  EXPECT_EQ(order, expected);
}

TEST(Jobs, LeaveEachAcquisitionOfTheEnvironmentOut) {
  std::set<std::string> tests;
  for (const Job& job : jobs_of({}, small_acquisitions())) tests.insert(job.test);
  EXPECT_THAT(tests, testing::ElementsAre("garden_acq-01", "garden_acq-02", "garden_acq-03"));
}

TEST(Jobs, EndAllWindowsAtTheSameFrames) {
  for (const Job& job : jobs_of({}, small_acquisitions())) EXPECT_EQ(job.history, 6);
  StudyConfig config;
  config.frames = {3};
  EXPECT_EQ(jobs_of(config, small_acquisitions()).front().history, 3);
  config.history = 6;
  EXPECT_EQ(jobs_of(config, small_acquisitions()).front().history, 6);
}

TEST(Jobs, DoNotDependOnTheOrderOfTheAcquisitions) {
  std::vector<network::Acquisition> acquisitions = small_acquisitions();
  const std::vector<Job> jobs = jobs_of({}, acquisitions);
  std::reverse(acquisitions.begin(), acquisitions.end());
  EXPECT_EQ(jobs_of({}, acquisitions), jobs);
}

TEST(Jobs, AreOthersWithOtherData) {
  std::vector<network::Acquisition> acquisitions = small_acquisitions();
  const std::vector<Job> jobs = jobs_of({}, acquisitions);
  acquisitions.pop_back();  // of the laboratory: training data of every fold
  const std::vector<Job> others = jobs_of({}, acquisitions);
  ASSERT_EQ(others.size(), jobs.size());
  EXPECT_NE(file_name_of(others.front()), file_name_of(jobs.front()));
}

TEST(Jobs, HaveTheLabelOfTheirAcquisitionsAndAreOthersWithAnother) {
  auto acquisitions = small_acquisitions();
  const Job commanded = jobs_of({}, acquisitions).front();
  EXPECT_EQ(commanded.label, Label::commanded);
  for (network::Acquisition& acquisition : acquisitions) {
    acquisition.label = Label::corrected;
    acquisition.label_hash = acquisition.hash + "c";
  }
  const Job corrected = jobs_of({}, acquisitions).front();
  EXPECT_EQ(corrected.label, Label::corrected);
  EXPECT_EQ(corrected.test_hash, commanded.test_hash);
  EXPECT_NE(corrected.data_hash, commanded.data_hash);
}

TEST(Jobs, CanBeOfOneSetUpAlone) {
  StudyConfig config;
  config.fusion = false;
  const std::vector<Job> jobs = jobs_of(config, small_acquisitions());
  EXPECT_EQ(jobs.size(), 27U);
  for (const Job& job : jobs) EXPECT_FALSE(job.fusion);
}

TEST(Jobs, AreRefusedWhereNothingCanBeLeftOut) {
  std::vector<network::Acquisition> acquisitions = small_acquisitions();
  StudyConfig config;
  config.environment = "kitchen";
  EXPECT_THAT(refusal(config, acquisitions), testing::HasSubstr("at least two of the environment kitchen"));
  acquisitions.erase(acquisitions.begin(), acquisitions.begin() + 2);
  EXPECT_THAT(refusal({}, acquisitions), testing::HasSubstr("there is 1"));
  EXPECT_THAT(refusal({}, {}), testing::HasSubstr("there are 0"));
}

TEST(Jobs, AreRefusedForTwoAcquisitionsOfOneName) {
  std::vector<network::Acquisition> acquisitions = small_acquisitions();
  acquisitions[1].name = acquisitions[0].name;
  EXPECT_THAT(refusal({}, acquisitions), testing::HasSubstr("same name"));
}

TEST(Jobs, AreRefusedForSettingsThatNoNetworkHas) {
  StudyConfig config;
  config.frames = {3, 7};
  EXPECT_NE(refusal(config, small_acquisitions()), "");
  config.frames = {3};
  config.reductions = {0};
  EXPECT_NE(refusal(config, small_acquisitions()), "");
  config.reductions = {1};
  config.epochs = 0;
  EXPECT_NE(refusal(config, small_acquisitions()), "");
  config.epochs = 1;
  config.seeds = {};
  config.reference_seeds = {};
  EXPECT_NE(refusal(config, small_acquisitions()), "");
}

TEST(JobFileName, DiffersWhereAnythingOfTheJobDiffers) {
  std::vector<Job> jobs(14);
  jobs[1].engine += 1;
  jobs[2].frames = 4;
  jobs[3].reduction = 2;
  jobs[4].fusion = false;
  jobs[5].seed = 2;
  jobs[6].preset = "best";
  jobs[7].settings = "batch 16";
  jobs[8].epochs = 39;
  jobs[9].history = 5;
  jobs[10].test = "garden_acq-02";
  jobs[11].test_hash = "00";
  jobs[12].data_hash = "00";
  jobs[13].label = Label::shaft;
  std::set<std::string> names;
  for (const Job& job : jobs) names.insert(file_name_of(job));
  EXPECT_EQ(names.size(), jobs.size());
}

TEST(JobFileName, NeverLeadsOutOfTheFolder) {
  Job job;
  job.test = "../../etc/passwd\n";
  job.preset = "/";
  EXPECT_EQ(file_name_of(job).find_first_of("/\n"), std::string::npos);
  EXPECT_EQ(file_name_of(job).front(), '_');
}

}  // namespace
}  // namespace thermorig::study
