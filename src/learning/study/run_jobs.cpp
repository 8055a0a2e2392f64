// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <thread>

#include "folder_lock.h"
#include "job_board.h"
#include "result_file.h"
#include "thermorig/core/error.h"

namespace thermorig::study {

namespace {

namespace fs = std::filesystem;
using network::Acquisition;

training::Observer observer_of(JobBoard& board, std::size_t index) {
  training::Observer observer;
  observer.epoch = [&board, index](const training::EpochReport& epoch, const training::Checkpoint&) {
    board.epoch_done(index, epoch.epoch);
  };
  observer.stop = [&board] { return board.stopping(); };
  return observer;
}

void work(JobBoard& board, std::span<const Acquisition> acquisitions, const fs::path& folder) try {
  while (const std::optional<std::size_t> index = board.take()) {
    const std::optional<JobResult> result =
        run_job(board.job(*index), acquisitions, observer_of(board, *index));
    if (!result) return;
    write_result(folder, *result);
    board.job_done(*index);
  }
} catch (...) {
  board.failed(std::current_exception());
}

/// Another label's results would stand in the same tables as if they were of this study.
void refuse_other_label(const fs::path& folder, std::span<const Job> jobs) {
  if (jobs.empty()) return;
  for (const fs::path& file : result_files(folder)) {
    const Label there = read_result(file).job.label;
    if (there == jobs.front().label) continue;
    throw Error(
        ExitCode::bad_usage,
        fmt::format("the study there learns from {}, this one from {}", column_of(there),
                    column_of(jobs.front().label)),
        file.string(),
        fmt::format("go on with --label {}, or give this study another folder with -o", name_of(there)));
  }
}

std::vector<Job> without_result(std::span<const Job> jobs, const fs::path& folder) {
  std::vector<Job> left;
  for (const Job& job : jobs)
    if (!find_result(folder, job)) left.push_back(job);
  return left;
}

}  // namespace

bool run_jobs(std::span<const Job> jobs, std::span<const Acquisition> acquisitions, const fs::path& folder,
              int workers, const RunObserver& observer) {
  assert(workers >= 1);
  const FolderLock lock(folder);
  remove_parts(folder);
  refuse_other_label(folder, jobs);
  std::vector<Job> left = without_result(jobs, folder);
  const std::size_t count = left.size();
  const std::size_t threads = std::min(static_cast<std::size_t>(workers), count);
  JobBoard board(std::move(left), jobs.size() - count, observer);
  std::vector<std::jthread> team;
  for (std::size_t i = 0; i < threads; ++i) team.emplace_back([&] { work(board, acquisitions, folder); });
  team.clear();  // waits for them
  return board.concluded();
}

}  // namespace thermorig::study
