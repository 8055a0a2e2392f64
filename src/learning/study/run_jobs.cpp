// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <thread>

#include "job_board.h"
#include "job_claims.h"
#include "result_file.h"
#include "thermorig/core/error.h"

namespace thermorig::study {

namespace {

namespace fs = std::filesystem;
using network::Acquisition;

training::Observer observer_of(JobBoard& board, const TakenJob& taken) {
  training::Observer observer;
  observer.epoch = [&board, &taken](const training::EpochReport& epoch, const training::Checkpoint&) {
    board.epoch_done(taken.index, epoch.epoch);
  };
  observer.stop = [&board, &taken] { return board.stopping() || taken.claim->is_taken_over(); };
  return observer;
}

void work(JobBoard& board, std::span<const Acquisition> acquisitions, const fs::path& folder) try {
  while (const std::optional<TakenJob> taken = board.take()) {
    const std::optional<JobResult> result =
        run_job(board.job(taken->index), acquisitions, observer_of(board, *taken));
    if (!result) {
      board.lost(taken->index);
      continue;
    }
    write_result(folder, *result);
    taken->claim->remove();
    board.job_done(taken->index);
  }
} catch (...) {
  board.failed(std::current_exception());
}

std::vector<Job> without_result(std::span<const Job> jobs, const fs::path& folder) {
  std::vector<Job> left;
  for (const Job& job : jobs)
    if (!find_result(folder, job)) left.push_back(job);
  return left;
}

}  // namespace

void require_label(Label label, const fs::path& folder) {
  if (!fs::exists(folder)) return;
  for (const fs::path& file : result_files(folder)) {
    const Label there = read_result(file).job.label;
    if (there == label) continue;
    throw Error(
        ExitCode::bad_usage,
        fmt::format("the study there learns from {}, this one from {}", column_of(there), column_of(label)),
        file.string(),
        fmt::format("go on with --label {}, or give this study another folder with -o", name_of(there)));
  }
}

bool run_jobs(std::span<const Job> jobs, std::span<const Acquisition> acquisitions, const fs::path& folder,
              int workers, const RunObserver& observer, const files::ClaimTiming& timing) {
  assert(workers >= 1);
  make_results_folder(folder);
  remove_litter(folder);
  if (!jobs.empty()) require_label(jobs.front().label, folder);
  const std::vector<Job> left = without_result(jobs, folder);
  const std::size_t threads = std::min(static_cast<std::size_t>(workers), left.size());
  JobBoard board(left, jobs.size() - left.size(), folder, observer, timing);
  std::vector<std::jthread> team;
  for (std::size_t i = 0; i < threads; ++i) team.emplace_back([&] { work(board, acquisitions, folder); });
  team.clear();  // waits for them
  return board.concluded();
}

}  // namespace thermorig::study
