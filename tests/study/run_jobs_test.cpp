// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include <cmath>
#include <fstream>

#include "small_study.h"
#include "thermorig/io/files/part_file.h"

namespace thermorig::study {
namespace {

namespace fs = std::filesystem;

class RunJobs : public SmallStudy {};

TEST_F(RunJobs, AreRefusedAFolderWithResultsOfAnotherLabel) {
  config_.frames = {2};
  config_.reference_frames = 2;
  reused(folder_);
  for (network::Acquisition& acquisition : acquisitions_) {
    acquisition.label = Label::shaft;
    acquisition.label_hash = acquisition.hash + "s";
  }
  const Error error = refusal();
  EXPECT_EQ(error.code(), ExitCode::bad_usage);
  EXPECT_EQ(error.what_happened(), "the study there learns from rate_commanded, this one from rate_shaft");
  EXPECT_THAT(error.advice(), testing::HasSubstr("--label commanded"));
  EXPECT_EQ(reused(folder_ / "other"), 0U);
  EXPECT_EQ(read_results(folder_ / "other").front().job.label, Label::shaft);
}

TEST_F(RunJobs, LeaveAResultEach) {
  EXPECT_EQ(reused(folder_), 0U);
  const std::vector<JobResult> results = results_of(jobs(), folder_);
  ASSERT_EQ(results.size(), 8U);  // 2 folds, 2 set-ups, 2 Nf
  for (const JobResult& result : results) {
    // Windows of every Nf end at the same frames: those with 3 valid ones in a row.
    EXPECT_EQ(result.evaluation.errors[thermal_name].windows, 20U);
    EXPECT_EQ(result.training_windows, 60U);
    EXPECT_EQ(result.evaluation.errors[fusion_name].windows, result.job.fusion ? 20U : 0U);
    EXPECT_GT(result.evaluation.errors[thermal_name].mse, 0.0);
    EXPECT_EQ(result.evaluation.names, std::vector<std::string>{result.job.test});
    EXPECT_EQ(result.training_mse.size(), 1U);
    EXPECT_EQ(result.epoch_kept, 1);
    EXPECT_GT(result.weights, 40'000U);
  }
}

TEST_F(RunJobs, GiveTheSameWithAnyNumberOfWorkers) {
  reused(folder_ / "one", 1);
  reused(folder_ / "three", 3);
  EXPECT_EQ(timeless(folder_ / "one"), timeless(folder_ / "three"));
}

TEST_F(RunJobs, AreNeverRepeated) {
  reused(folder_);
  const auto before = timeless(folder_);
  EXPECT_EQ(reused(folder_, 2), 8U);
  EXPECT_EQ(timeless(folder_), before);
}

TEST_F(RunJobs, GoOnAfterAStop) {
  std::size_t done = 0;
  RunObserver observer;
  observer.job_done = [&](const Progress& progress) { done = progress.done; };
  observer.stop = [&] { return done == 3; };
  EXPECT_FALSE(run_jobs(jobs(), acquisitions_, folder_, 1, observer));
  EXPECT_EQ(results_of(jobs(), folder_).size(), 3U);
  EXPECT_EQ(reused(folder_), 3U);
}

TEST_F(RunJobs, AreStoppedInTheMiddleOfATraining) {
  config_.epochs = 5;
  int epochs = 0;
  RunObserver observer;
  observer.epoch_done = [&](const Progress&) { ++epochs; };
  observer.stop = [&] { return epochs == 2; };
  EXPECT_FALSE(run_jobs(jobs(), acquisitions_, folder_, 1, observer));
  EXPECT_EQ(epochs, 2);
  EXPECT_TRUE(results_of(jobs(), folder_).empty());
}

TEST_F(RunJobs, GoOnAfterAKillWithoutRepeatingAJob) {
  const pid_t child = fork();
  if (child == 0) {
    RunObserver observer;
    observer.job_done = [](const Progress& progress) {
      if (progress.done == 3) raise(SIGKILL);
    };
    run_jobs(jobs(), acquisitions_, folder_, 1, observer);
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(reused(folder_), 3U);
  EXPECT_EQ(results_of(jobs(), folder_).size(), 8U);
}

TEST_F(RunJobs, RemoveWhatAKilledRunLeftHalfWritten) {
  const fs::path result = folder_ / file_name_of(jobs().front());
  const std::string never_a_process = std::to_string(1 << 30);  // beyond the most that the kernel gives
  const fs::path ours = result.string() + "." + files::host_name() + "." + never_a_process + ".part";
  const fs::path alive = result.string() + "." + files::host_name() + ".1.part";
  const fs::path elsewhere = result.string() + ".another-host." + never_a_process + ".part";
  for (const fs::path& part : {ours, alive, elsewhere}) std::ofstream(part) << "{\"format\":";
  EXPECT_EQ(reused(folder_), 0U);
  EXPECT_FALSE(fs::exists(ours));
  for (const fs::path& part : {alive, elsewhere}) EXPECT_TRUE(fs::exists(part)) << part;
}

TEST_F(RunJobs, DoNotTakeResultsOfOtherJobs) {
  reused(folder_);
  config_.epochs = 2;
  EXPECT_EQ(reused(folder_), 0U);
  acquisitions_[3].hash = "another";
  EXPECT_EQ(reused(folder_ / "other"), 0U);
}

TEST_F(RunJobs, NameADamagedResultBeforeAnythingIsTrained) {
  reused(folder_);
  const std::vector<Job> all = jobs();
  const fs::path damaged = folder_ / file_name_of(all[6]);
  fs::resize_file(damaged, fs::file_size(damaged) / 2);
  fs::remove(folder_ / file_name_of(all[0]));
  const Error error = refusal();
  EXPECT_EQ(error.code(), ExitCode::not_a_session);
  EXPECT_EQ(error.where(), damaged.string());
  EXPECT_THAT(error.advice(), testing::HasSubstr("delete it"));
  EXPECT_FALSE(fs::exists(folder_ / file_name_of(all[0])));
  EXPECT_THROW(read_results(folder_), Error);
}

TEST_F(RunJobs, NameAResultThatHoldsAnotherJob) {
  reused(folder_);
  const std::vector<Job> all = jobs();
  fs::copy_file(folder_ / file_name_of(all[0]), folder_ / file_name_of(all[1]),
                fs::copy_options::overwrite_existing);
  EXPECT_EQ(refusal().where(), (folder_ / file_name_of(all[1])).string());
}

TEST_F(RunJobs, SayWhenTheFolderCannotBeMade) {
  std::ofstream(folder_ / "file") << "x";
  folder_ /= "file";
  EXPECT_EQ(refusal().code(), ExitCode::storage);
}

TEST_F(RunJobs, PassOnWhatATrainingThrows) {
  const std::vector<Job> all = jobs();
  acquisitions_[3].hash = "another";
  EXPECT_THROW(run_jobs(all, acquisitions_, folder_, 2), Error);
}

TEST_F(RunJobs, TellHowFarTheyAre) {
  config_.epochs = 2;
  std::vector<double> shares;
  RunObserver observer;
  observer.epoch_done = [&](const Progress& progress) {
    shares.push_back(progress.share);
    EXPECT_GE(progress.eta_s, 0.0);
    EXPECT_THAT(progress.last, testing::StartsWith("garden_acq-0"));
  };
  run_jobs(jobs(), acquisitions_, folder_, 1, observer);
  ASSERT_EQ(shares.size(), 16U);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_GT(shares.front(), 0.0);
  EXPECT_NEAR(shares.back(), 1.0, 1e-12);
}

TEST_F(RunJobs, KeepTheResultsOfEachDataSetApart) {
  reused(folder_);
  acquisitions_[3].hash = "another";
  reused(folder_);
  EXPECT_THROW(read_results(folder_), Error);
  EXPECT_EQ(results_of(jobs(), folder_).size(), 8U);
}

TEST_F(RunJobs, HaveNoResultsInAnEmptyFolder) {
  EXPECT_THROW(read_results(folder_), Error);
  EXPECT_THROW(read_results(folder_ / "missing"), Error);
  EXPECT_TRUE(results_of(jobs(), folder_).empty());
}

/// Results of a study of which an estimator without a network says something else later. A hash of the data
/// does not tell: no training sees it.
class Baselines : public RunJobs {
 protected:
  Baselines() {
    reused(folder_ / "before");
    for (network::Acquisition& acquisition : acquisitions_)
      for (float& rate_dps : acquisition.rates.at(1).rate_dps) rate_dps += 3.0F;
  }
};

TEST_F(Baselines, AreThoseOfAStudyThatIsRunAnew) {
  const auto before = timeless(folder_ / "before");
  reused(folder_ / "after");
  const RenewedBaselines renewed = renew_baselines(folder_ / "before", acquisitions_);
  EXPECT_EQ(renewed.results, 8U);
  EXPECT_EQ(renewed.changed, 8U);
  EXPECT_NE(timeless(folder_ / "before"), before);
  EXPECT_EQ(timeless(folder_ / "before"), timeless(folder_ / "after"));
  EXPECT_EQ(renew_baselines(folder_ / "before", acquisitions_).changed, 0U);
}

TEST_F(Baselines, OfOtherSessionsAreRefusedBeforeAnythingIsWritten) {
  const auto before = timeless(folder_ / "before");
  for (const bool another : {true, false}) {
    if (another) acquisitions_[3].hash = "another";
    if (!another) acquisitions_.pop_back();
    EXPECT_THROW(renew_baselines(folder_ / "before", acquisitions_), Error);
  }
  EXPECT_EQ(timeless(folder_ / "before"), before);
}

TEST_F(Baselines, OfOtherWindowsAreRefused) {
  for (network::Acquisition& acquisition : acquisitions_)
    acquisition.run[5] = 0;  // though the hash is the same
  EXPECT_THROW(renew_baselines(folder_ / "before", acquisitions_), Error);
}

}  // namespace
}  // namespace thermorig::study
