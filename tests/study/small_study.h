// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "support/synthetic_acquisitions.h"
#include "thermorig/core/error.h"
#include "thermorig/learning/study/study.h"

namespace thermorig::study {

/// Eight jobs of one epoch over four small acquisitions, and a folder of their own.
class SmallStudy : public ::testing::Test {
 protected:
  SmallStudy() {
    std::string name = (std::filesystem::temp_directory_path() / "thermorig-study-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) std::abort();
    folder_ = name;
    config_.frames = {2, 3};
    config_.reductions = {3};
    config_.reference_reduction = 3;
    config_.reference_seeds = {1};
    config_.epochs = 1;
  }
  ~SmallStudy() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  std::vector<Job> jobs() const { return jobs_of(config_, acquisitions_); }

  /// Runs them all; how many had a result before.
  std::size_t reused(const std::filesystem::path& folder, int workers = 1) const {
    Progress last;
    RunObserver observer;
    observer.started = observer.job_done = [&](const Progress& progress) { last = progress; };
    EXPECT_TRUE(run_jobs(jobs(), acquisitions_, folder, workers, observer));
    EXPECT_EQ(last.done, jobs().size());
    EXPECT_EQ(last.all, jobs().size());
    return last.reused;
  }

  /// File names to results without the time they took.
  static std::map<std::string, std::string> timeless(const std::filesystem::path& folder) {
    std::map<std::string, std::string> texts;
    for (JobResult& result : read_results(folder)) {
      result.seconds = 0.0;
      texts[file_name_of(result.job)] = to_json(result);
    }
    return texts;
  }

  Error refusal(int workers = 1) const {
    try {
      run_jobs(jobs(), acquisitions_, folder_, workers);
    } catch (const Error& error) {
      return error;
    }
    return {ExitCode::ok, "", "", ""};
  }

  std::filesystem::path folder_;
  StudyConfig config_;
  std::vector<network::Acquisition> acquisitions_ = synthetic::make_acquisitions(
      {"garden", "laboratory"}, 2, 1, {.rates_dps = {-100.0F, 100.0F}, .frames_per_leg = 12});
};

}  // namespace thermorig::study
