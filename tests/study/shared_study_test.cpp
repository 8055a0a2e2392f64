// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <random>
#include <thread>

#include "io/files/claim_text.h"
#include "learning/study/job_claims.h"
#include "learning/study/result_file.h"
#include "small_study.h"

namespace thermorig::study {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

/// Programs that run the same study in the same folder.
class SharedStudy : public SmallStudy {
 protected:
  /// A program of its own with one worker. Returns its process.
  pid_t start(const fs::path& folder) const {
    const pid_t child = ::fork();
    if (child == 0) {
      try {
        ::_exit(run_jobs(jobs(), acquisitions_, folder, 1, {}, quick_) ? 0 : 1);
      } catch (...) {
        ::_exit(2);
      }
    }
    return child;
  }

  static int code_of(pid_t child) {
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

  void claim_elsewhere(const Job& job, int number = 1) const {
    fs::create_directories(folder_);
    std::ofstream(claim_name(folder_, job).string() + ".claim." + std::to_string(number))
        << files::claim_text({"node7", "0123-4567", 9, 4711, 500}, "2026-11-24T03:49:01Z");
  }

  /// What lies in the folder beside results.
  std::vector<fs::path> others() const {
    std::vector<fs::path> paths;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_))
      if (entry.path().extension() != ".json") paths.push_back(entry.path());
    return paths;
  }

  std::map<std::string, std::string> expected() const {
    reused(folder_ / "alone");
    auto texts = timeless(folder_ / "alone");
    fs::remove_all(folder_ / "alone");
    return texts;
  }

  static constexpr files::ClaimTiming quick_{.beat = milliseconds(2), .patience = milliseconds(40)};
  static constexpr files::ClaimTiming patient_{.beat = milliseconds(2), .patience = std::chrono::hours(1)};
};

TEST_F(SharedStudy, HasEachResultOnceAndTheSameAsOfOneProgram) {
  const auto alone = expected();
  std::vector<pid_t> programs;
  for (int i = 0; i < 4; ++i) programs.push_back(start(folder_));
  for (const pid_t program : programs) EXPECT_EQ(code_of(program), 0);
  EXPECT_EQ(timeless(folder_), alone);
  EXPECT_THAT(others(), testing::IsEmpty());
}

TEST_F(SharedStudy, LosesNothingWhenProgramsAreKilledAtAnyInstant) {
  config_.epochs = 3;
  const auto alone = expected();
  std::mt19937 random(3);
  std::map<std::string, std::string> written;  // results never change again once they are there
  for (int kill = 0; kill < 15; ++kill) {
    const pid_t victim = start(folder_), other = start(folder_);
    std::this_thread::sleep_for(milliseconds(random() % 30));
    for (const pid_t program : {victim, other}) ::kill(program, SIGKILL);
    for (const pid_t program : {victim, other}) code_of(program);
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
      if (entry.path().extension() != ".json") continue;
      const std::string text = to_json(read_result(entry.path()));
      const auto first = written.emplace(entry.path().filename(), text).first;
      EXPECT_EQ(first->second, text);
    }
  }
  EXPECT_EQ(code_of(start(folder_)), 0);
  EXPECT_EQ(timeless(folder_), alone);
  EXPECT_THAT(others(), testing::IsEmpty());
}

TEST_F(SharedStudy, WaitsForWhatAnotherHoldsAndSaysWhoItIs) {
  const std::vector<Job> all = jobs();
  const fs::path elsewhere = folder_ / "elsewhere";
  reused(elsewhere);
  claim_elsewhere(all[2]);
  std::vector<std::string> held;
  std::size_t done = 0;
  RunObserver observer;
  observer.job_done = [&](const Progress& progress) { done = progress.done; };
  observer.held = [&](const Job& job, const files::ClaimSight& claim) {
    EXPECT_EQ(done, 7U);  // all else comes first
    EXPECT_EQ(job, all[2]);
    held.push_back(files::text_of(claim));
    fs::rename(elsewhere / file_name_of(job), folder_ / file_name_of(job));  // it has finished
  };
  EXPECT_TRUE(run_jobs(all, acquisitions_, folder_, 1, observer, patient_));
  EXPECT_THAT(held, testing::ElementsAre("node7, process 4711, since 2026-11-24T03:49:01Z"));
  EXPECT_EQ(done, 8U);
}

TEST_F(SharedStudy, IsStoppedWhileItWaits) {
  claim_elsewhere(jobs()[2]);
  bool waits = false;
  RunObserver observer;
  observer.held = [&](const Job&, const files::ClaimSight&) { waits = true; };
  observer.stop = [&] { return waits; };
  EXPECT_FALSE(run_jobs(jobs(), acquisitions_, folder_, 1, observer, patient_));
  EXPECT_EQ(results_of(jobs(), folder_).size(), 7U);
}

TEST_F(SharedStudy, TakesOverWhatAnotherMachineLeftBehind) {
  claim_elsewhere(jobs()[2]);
  claim_elsewhere(jobs()[5]);
  EXPECT_TRUE(run_jobs(jobs(), acquisitions_, folder_, 2, {}, quick_));
  EXPECT_EQ(results_of(jobs(), folder_).size(), 8U);
  EXPECT_THAT(others(), testing::IsEmpty());
}

TEST_F(SharedStudy, GivesUpAJobThatWasTakenOver) {
  config_.epochs = 100'000;  // only ends by being given up
  const Job job = jobs().front();
  const fs::path elsewhere = folder_ / "elsewhere";
  config_.epochs = 1;
  reused(elsewhere);
  JobResult result = read_results(elsewhere).front();
  result.job = job;
  int epochs = 0;
  RunObserver observer;
  observer.epoch_done = [&](const Progress&) {
    if (++epochs == 1) claim_elsewhere(job, 2);
  };
  observer.held = [&](const Job&, const files::ClaimSight& claim) {
    EXPECT_EQ(claim.number, 2);
    write_result(folder_, result);
  };
  EXPECT_TRUE(run_jobs(std::vector{job}, acquisitions_, folder_, 1, observer, patient_));
  EXPECT_EQ(to_json(read_result(folder_ / file_name_of(job))), to_json(result));
  EXPECT_FALSE(fs::exists(claim_name(folder_, job).string() + ".claim.1"));
}

TEST_F(SharedStudy, KeepsTheFirstResultOfAJob) {
  reused(folder_);
  const JobResult first = read_results(folder_).front();
  JobResult second = first;
  second.seconds += 100.0;
  write_result(folder_, second);
  EXPECT_EQ(to_json(read_results(folder_).front()), to_json(first));
  EXPECT_THAT(others(), testing::IsEmpty());
}

TEST_F(SharedStudy, CleansUpClaimsOfWhatIsDone) {
  reused(folder_);
  claim_elsewhere(jobs()[3]);
  reused(folder_);
  EXPECT_THAT(others(), testing::IsEmpty());
}

TEST_F(SharedStudy, ShowsWhereEachJobStands) {
  const std::vector<Job> all = jobs();
  run_jobs(std::span(all).first(2), acquisitions_, folder_, 1);
  claim_elsewhere(all[2]);
  files::Claim::take(claim_name(folder_, all[3]), {})->give_up();
  const auto ours = files::Claim::take(claim_name(folder_, all[4]), {});
  std::ofstream(claim_name(folder_, all[5]).string() + ".claim.1") << files::claim_text(
      {files::this_process().host, files::this_process().boot, files::this_process().space, 1U << 30U, 5},
      "2026-11-24T03:49:01Z");
  std::vector<JobState> states;
  const std::vector<JobStanding> standings = standings_of(all, folder_);
  for (const JobStanding& standing : standings) states.push_back(standing.state);
  using enum JobState;
  EXPECT_THAT(states, testing::ElementsAre(done, done, claimed, open, claimed, open, open, open));
  EXPECT_EQ(standings[2].claim.holder->host, "node7");
  EXPECT_EQ(standings[4].claim.holder, files::this_process());
}

TEST_F(SharedStudy, HasNoBaselinesRenewedWhileAProgramRunsIt) {
  reused(folder_);
  fs::remove(folder_ / file_name_of(jobs()[2]));
  claim_elsewhere(jobs()[2]);
  try {
    renew_baselines(folder_, acquisitions_);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::no_permission);
    EXPECT_EQ(error.what_happened(),
              "node7, process 4711, since 2026-11-24T03:49:01Z is running a job of this study");
  }
  fs::remove(claim_name(folder_, jobs()[2]).string() + ".claim.1");
  EXPECT_EQ(renew_baselines(folder_, acquisitions_).results, 7U);
}

}  // namespace
}  // namespace thermorig::study
