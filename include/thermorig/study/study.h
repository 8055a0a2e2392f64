// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "thermorig/study/evaluation.h"
#include "thermorig/training/training.h"

namespace thermorig::study {

/// The paper's study (section IV): leave one acquisition of an environment out, train on all the rest, test
/// on it.
struct StudyConfig {
  std::string environment = "garden";      // whose acquisitions are the folds
  std::vector<int> frames{2, 3, 4, 5, 6};  // sweep 1, at the reference Nr
  std::vector<int> reductions{1, 2, 3};    // sweep 2, at the reference Nf
  int reference_frames = 3;
  int reference_reduction = 1;
  std::vector<std::uint64_t> seeds{1};
  std::vector<std::uint64_t> reference_seeds{1, 2, 3};  // at the reference Nf and Nr: the spread over seeds
  std::string preset = "paper";
  int epochs = 40;
  bool thermal_only = true, fusion = true;  // which of the two set-ups
};

/// One training and its test. All windows of a study end at the same frames, those with `history` valid
/// frames in a row.
struct Job {
  int frames = 3;
  int reduction = 1;
  bool fusion = true;
  std::uint64_t seed = 1;
  std::string preset;
  int epochs = 40;
  int history = 6;
  std::string test;  // name of the acquisition that is left out
  std::string test_hash;
  std::string data_hash;  // over the hashes of all acquisitions, sorted
  auto operator<=>(const Job&) const = default;
};

/// File name of a job's result, without folder: says what it is and differs where anything of the job
/// differs.
std::string file_name_of(const Job& job);

/// What a job leaves behind: one small file.
struct JobResult {
  Job job;
  Evaluation evaluation;
  bool simulated = false;
  std::uint64_t training_windows = 0;
  std::vector<double> training_mse;  // by epoch
  int epoch_kept = 0;
  std::size_t weights = 0;
  std::uint64_t multiply_adds = 0;
  double seconds = 0.0;  // that the job took
  std::string instruction_set;
};

/// All jobs of a study, those of the reference first. Throws Error(bad_usage) for fewer than two acquisitions
/// of the environment.
std::vector<Job> jobs_of(const StudyConfig& config, std::span<const windows::Acquisition> acquisitions);

/// Trains and tests. Deterministic but for `seconds`.
JobResult run_job(const Job& job, std::span<const windows::Acquisition> acquisitions,
                  const training::Observer& observer = {});

/// Runs the jobs that have no result in `folder` yet, `workers` at a time, each result written whole or not
/// at all.
struct Progress {
  std::size_t done = 0, all = 0, reused = 0;
  double eta_s = 0.0;  // NaN before the first job has ended
  std::string last;    // the job that just ended, in words
};
struct RunObserver {
  std::function<void(const Progress&)> job_done;
  std::function<bool()> stop;  // true: running jobs are given up, finished ones stay
};
/// Returns false if it was stopped.
bool run_jobs(std::span<const Job> jobs, std::span<const windows::Acquisition> acquisitions,
              const std::filesystem::path& folder, int workers, const RunObserver& observer = {});

/// The results in a folder. Throws Error(not_a_session) for a file that is damaged.
std::vector<JobResult> read_results(const std::filesystem::path& folder);
std::string to_json(const JobResult& result);
JobResult result_from_json(const std::string& text, const std::string& where);

/// One row of a table: all folds of one setting and seed.
struct SettingSummary {
  int frames = 0, reduction = 0;
  bool fusion = true;
  std::uint64_t seed = 1;
  std::string preset;
  std::size_t folds = 0;
  std::array<std::vector<double>, estimator_count> fold_mse;  // one a fold, in the order of the test's name
  std::array<Spread, estimator_count> mse;
  std::array<double, estimator_count> rmse_dps{};  // square root of the median, times the label scale
  GainStatistics gain;                             // over all folds
  std::size_t weights = 0;
  std::uint64_t multiply_adds = 0;
};
std::vector<SettingSummary> summarise(std::span<const JobResult> results);

}  // namespace thermorig::study
