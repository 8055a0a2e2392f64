// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <random>
#include <thread>

#include "learning/study/result_file.h"
#include "small_study.h"
#include "thermorig/learning/study/shard.h"

namespace thermorig::study {
namespace {

namespace fs = std::filesystem;

/// Programs that run jobs of one study in the same folder.
class SharedStudy : public SmallStudy {
 protected:
  /// A program of its own with one worker, which runs a shard. Returns its process.
  pid_t start(const Shard& shard) const {
    const pid_t child = ::fork();
    if (child == 0) {
      try {
        ::_exit(run_jobs(jobs_of(shard, jobs()), acquisitions_, folder_, 1) ? 0 : 1);
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

  /// What lies in the folder beside results.
  std::vector<fs::path> others() const {
    std::vector<fs::path> paths;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_))
      if (entry.path().extension() != ".json") paths.push_back(entry.path());
    return paths;
  }

  /// The results of a shard that one program runs, alone.
  std::map<std::string, std::string> expected(const Shard& shard) const {
    const fs::path alone = folder_ / "alone";
    run_jobs(jobs_of(shard, jobs()), acquisitions_, alone, 1);
    auto texts = timeless(alone);
    fs::remove_all(alone);
    return texts;
  }
};

TEST_F(SharedStudy, HasTheSameResultsFromAShardAProgramAsFromOneProgram) {
  const auto alone = expected({1, 1});
  std::vector<pid_t> programs;
  for (int i = 1; i <= 3; ++i) programs.push_back(start({i, 3}));
  for (const pid_t program : programs) EXPECT_EQ(code_of(program), 0);
  EXPECT_EQ(timeless(folder_), alone);
  EXPECT_THAT(others(), testing::IsEmpty());
}

TEST_F(SharedStudy, HasTheSameResultsFromThreeProgramsOnOneShardThatAreKilledAtRandom) {
  config_.epochs = 3;
  constexpr Shard shard{1, 2};
  const auto alone = expected(shard);
  std::mt19937 random(3);
  std::map<std::string, std::string> written;  // results never change again once they are there
  for (int round = 0; round < 15; ++round) {
    std::vector<pid_t> programs;
    for (int i = 0; i < 3; ++i) programs.push_back(start(shard));
    for (const pid_t program : programs) {
      std::this_thread::sleep_for(std::chrono::milliseconds(random() % 15));
      ::kill(program, SIGKILL);
    }
    for (const pid_t program : programs) code_of(program);
    for (const fs::path& file : result_files(folder_)) {
      const std::string text = to_json(read_result(file));
      EXPECT_EQ(written.emplace(file, text).first->second, text);
    }
  }
  std::vector<pid_t> programs;
  for (int i = 0; i < 3; ++i) programs.push_back(start(shard));
  for (const pid_t program : programs) EXPECT_EQ(code_of(program), 0);
  EXPECT_EQ(timeless(folder_), alone);
  EXPECT_THAT(others(), testing::IsEmpty());
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

TEST_F(SharedStudy, PassesByWhatAnotherProgramHasDoneMeanwhile) {
  const std::vector<Job> all = jobs();
  reused(folder_ / "elsewhere");
  std::size_t epochs = 0, done = 0;
  RunObserver observer;
  observer.epoch_done = [&](const Progress&) {
    if (++epochs == 1)
      for (const Job& job : std::span(all).subspan(1))
        fs::rename(folder_ / "elsewhere" / file_name_of(job), folder_ / file_name_of(job));
  };
  observer.job_done = [&](const Progress& progress) { done = progress.done; };
  EXPECT_TRUE(run_jobs(all, acquisitions_, folder_, 1, observer));
  EXPECT_EQ(epochs, 1U);
  EXPECT_EQ(done, 8U);
}

TEST_F(SharedStudy, ShowsWhichJobsHaveNoResult) {
  const std::vector<Job> all = jobs();
  run_jobs(std::span(all).first(2), acquisitions_, folder_, 1);
  EXPECT_EQ(without_result(all, folder_), std::vector<Job>(all.begin() + 2, all.end()));
  EXPECT_EQ(without_result(all, folder_ / "none"), all);
}

}  // namespace
}  // namespace thermorig::study
