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

#include "thermorig/learning/study/evaluation.h"
#include "thermorig/learning/training/training.h"

namespace thermorig::study {

/// Raised when the same job would give another result: it is part of each job, so that results of an older
/// engine are not taken for those of this one.
inline constexpr int engine_version = 1;

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
  int history = 0;  // valid frames in a row that a window's end needs; 0: the largest Nf of the study
};

/// One training and its test: its identity, without time, machine or path. All windows of a study end at the
/// same frames, those with `history` valid frames in a row.
struct Job {
  int engine = engine_version;
  int frames = 3;
  int reduction = 1;
  bool fusion = true;
  std::uint64_t seed = 1;
  std::string preset;
  Label label = Label::commanded;
  std::string settings;  // what the preset stands for, in words: see settings_of
  int epochs = 40;
  int history = 6;
  std::string test;  // name of the acquisition that is left out
  std::string test_hash;
  std::string data_hash;  // over the learnt_hash() of all acquisitions, sorted
  auto operator<=>(const Job&) const = default;
};

/// What a training configuration sets beyond a job's own fields, as one line: batch, loss, Adam, mirror,
/// choice of the epoch, label scale. Another preset under the same name is so another job.
std::string settings_of(const training::TrainingConfig& config);

/// In words, for progress: "garden_acq-01, Nf 3, Nr 1, fusion, seed 1".
std::string description_of(const Job& job);

/// File name of a job's result, without folder: says what it is and differs where anything of the job
/// differs.
std::string file_name_of(const Job& job);

/// What a job is called on the command line: its result's file name without ".json".
std::string id_of(const Job& job);

/// What a job leaves behind: one small file.
struct JobResult {
  Job job;
  Evaluation evaluation;
  bool simulated = false;              // any of the acquisitions
  double label_scale_dps = 200.0;      // that errors are normalised by
  std::uint64_t training_windows = 0;  // of all acquisitions but the test's
  std::vector<double> training_mse;    // by epoch
  int epoch_kept = 0;
  std::uint64_t weights = 0;
  std::uint64_t multiply_adds = 0;
  double seconds = 0.0;  // that the job took
  std::string instruction_set;
};

/// All jobs of a study, of the acquisitions' label, each once: those of the reference setting first, then the
/// other Nf, then the other Nr, then the other seeds of the reference, so that a study that was stopped can
/// be read. Throws Error(bad_usage) for fewer than two acquisitions of the environment, two of the same name,
/// and settings outside the network's.
std::vector<Job> jobs_of(const StudyConfig& config, std::span<const network::Acquisition> acquisitions);

/// Is it the acquisition that the job is tested on? Of that one run_job() takes the estimates without a
/// network.
bool is_test_of(const Job& job, const network::Acquisition& acquisition);

/// Trains on all acquisitions but the job's, and tests on that one, both with the job's label. Deterministic
/// but for `seconds`. Throws Error(bad_usage) if the acquisitions are not those that the job was made of.
/// Nothing if `observer.stop` ended the training early.
std::optional<JobResult> run_job(const Job& job, std::span<const network::Acquisition> acquisitions,
                                 const training::Observer& observer = {});

/// Computes the rows of the baselines() anew, which no training is behind, in all results of a folder, each
/// replaced whole: which may be stopped and run again; all else stays as it is. `acquisitions` are those that
/// the results were made of. Nothing is written if one of them cannot be renewed. Throws as read_results(),
/// and Error(bad_usage) if the acquisitions are others or have other windows than a result.
struct RenewedBaselines {
  std::size_t results = 0;  // that there are
  std::size_t changed = 0;  // that say something else now
};
RenewedBaselines renew_baselines(const std::filesystem::path& folder,
                                 std::span<const network::Acquisition> acquisitions);

/// Where a study stands. `eta_s` weighs what is left by multiply-adds and epochs.
struct Progress {
  std::size_t done = 0, all = 0, reused = 0;  // reused: of those done, found in the folder
  double share = 0.0;                         // of the work, 0..1, running jobs included
  double elapsed_s = 0.0;                     // since this run began
  double eta_s = 0.0;                         // NaN before the first epoch has ended
  std::string last;                           // the job that just ended or is running, in words
};

/// Told one at a time, from any of the workers. May be null functions.
struct RunObserver {
  std::function<void(const Progress&)> started;     // once, when it is known what is left
  std::function<void(const Progress&)> epoch_done;  // of any job
  std::function<void(const Progress&)> job_done;
  std::function<bool()> stop;  // true: running jobs are given up, finished ones stay; asked by all workers
};

/// Throws Error(bad_usage) where the folder has results of another label, which would stand in the same
/// tables as if they were of this study, Error(not_a_session) for a damaged result.
void require_label(Label label, const std::filesystem::path& folder);

/// Those of the jobs that have no result in `folder`, in their order. Throws Error(not_a_session) for a
/// damaged one.
std::vector<Job> without_result(std::span<const Job> jobs, const std::filesystem::path& folder);

/// Runs the jobs that have no result in `folder` yet, `workers` at a time, one thread each. A result is
/// written to another name, synced and renamed: it is there whole or not at all, is never replaced, and a job
/// that has one is not run again. So programs that run the same jobs in one folder, on this machine or
/// others, do no harm but to their time: jobs are deterministic, and the first result stays. Returns false if
/// it was stopped; true: all these jobs have a result. Throws as require_label() before anything is trained,
/// Error(storage) where results cannot be written.
bool run_jobs(std::span<const Job> jobs, std::span<const network::Acquisition> acquisitions,
              const std::filesystem::path& folder, int workers, const RunObserver& observer = {});

/// The results in a folder (*.json), sorted by file name. Throws Error(not_a_session) for a file that is
/// damaged, Error(bad_usage) for a folder without any, and for results of different data.
std::vector<JobResult> read_results(const std::filesystem::path& folder);

/// Those of them that belong to these jobs, in the order of the jobs; jobs without a result are left out.
std::vector<JobResult> results_of(std::span<const Job> jobs, const std::filesystem::path& folder);

/// A result as JSON and back: all numbers are read back equal, NaN stands as null. Throws
/// Error(not_a_session) for what is no result: the text is hostile.
std::string to_json(const JobResult& result);
JobResult result_from_json(const std::string& text, const std::string& where);

/// Whose kernels results were computed with: "AVX2", or of several "AVX-512 (72 results), AVX2 (12 results)",
/// the most first. Kernels of different instruction sets round differently.
std::string instruction_sets_of(std::span<const JobResult> results);

/// Were they computed with more than one?
bool mixes_instruction_sets(std::span<const JobResult> results);

/// One row of a table: all folds of one setting and seed. Results that differ in anything else of their job
/// but the fold (epochs, history, engine, data) never share a row.
struct SettingSummary {
  int frames = 0, reduction = 0;
  bool fusion = true;
  std::uint64_t seed = 1;
  std::string preset;
  int epochs = 0;
  std::size_t folds = 0;
  PerEstimator<std::vector<double>> fold_mse;  // one a fold, in the order of the test's name
  PerEstimator<Spread> mse;
  PerEstimator<double> rmse_dps;  // square root of the median, times the label scale
  GainStatistics gain;  // over all windows of all folds; its median is interpolated, see docs/evaluation.md
  std::size_t weights = 0;
  std::uint64_t multiply_adds = 0;
};
/// Ascending in Nf, Nr, thermal-only before fusion, then seed and preset.
std::vector<SettingSummary> summarise(std::span<const JobResult> results);

}  // namespace thermorig::study
