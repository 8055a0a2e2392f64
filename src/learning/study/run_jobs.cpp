// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <chrono>
#include <exception>
#include <limits>
#include <mutex>
#include <thread>
#include <utility>

#include "result_file.h"
#include "thermorig/core/error.h"

namespace thermorig::study {

namespace {

namespace fs = std::filesystem;
using network::Acquisition;

double work_of(const Job& job) {
  network::Shape shape;
  shape.frames = job.frames;
  shape.reduction = job.reduction;
  shape.fusion = job.fusion;
  return static_cast<double>(network::multiply_adds(shape)) * job.epochs;
}

/// Which jobs of a run are left, running and done, for its workers: every function may be called from any of
/// them, and the observer is called by one at a time.
class Board {
 public:
  /// `reused`: how many jobs beside these have a result.
  Board(std::vector<Job> jobs, std::size_t reused, const RunObserver& observer)
      : jobs_(std::move(jobs)), shares_(jobs_.size(), 0.0), reused_(reused), observer_(observer) {
    if (observer_.started) observer_.started(progress(nullptr));
  }

  /// None when all are taken, or the run is to end before.
  std::optional<std::size_t> take() {
    const std::lock_guard lock(mutex_);
    if (is_stopped() || next_ == jobs_.size()) return std::nullopt;
    return next_++;
  }
  const Job& job(std::size_t index) const { return jobs_[index]; }

  training::Observer observer_of(std::size_t index) {
    training::Observer observer;
    observer.epoch = [this, index](const training::EpochReport& epoch, const training::Checkpoint&) {
      const std::lock_guard lock(mutex_);
      shares_[index] = static_cast<double>(epoch.epoch) / jobs_[index].epochs;
      if (observer_.epoch_done) observer_.epoch_done(progress(&jobs_[index]));
    };
    observer.stop = [this] {
      const std::lock_guard lock(mutex_);
      return is_stopped();
    };
    return observer;
  }

  void done(std::size_t index) {
    const std::lock_guard lock(mutex_);
    shares_[index] = 1.0;
    ++done_;
    if (observer_.job_done) observer_.job_done(progress(&jobs_[index]));
  }

  void failed(const std::exception_ptr& failure) {
    const std::lock_guard lock(mutex_);
    if (!failure_) failure_ = failure;
  }

  /// After all workers have ended: throws what failed first; were all jobs done?
  bool concluded() const {
    if (failure_) std::rethrow_exception(failure_);
    return done_ == jobs_.size();
  }

 private:
  bool is_stopped() {
    if (!stopped_ && observer_.stop) stopped_ = observer_.stop();
    return stopped_ || failure_;
  }

  Progress progress(const Job* last) const {
    double all = 0.0, done = 0.0;
    for (std::size_t i = 0; i < jobs_.size(); ++i) {
      all += work_of(jobs_[i]);
      done += work_of(jobs_[i]) * shares_[i];
    }
    Progress progress;
    progress.all = reused_ + jobs_.size();
    progress.done = reused_ + done_;
    progress.reused = reused_;
    progress.share = all > 0.0 ? done / all : 1.0;
    progress.elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
    progress.eta_s = progress.share > 0.0 ? progress.elapsed_s * (1.0 - progress.share) / progress.share
                                          : std::numeric_limits<double>::quiet_NaN();
    if (last != nullptr) progress.last = description_of(*last);
    return progress;
  }

  std::vector<Job> jobs_;
  std::vector<double> shares_;  // of each job's work that is done
  std::size_t reused_;
  const RunObserver& observer_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();

  std::mutex mutex_;
  std::size_t next_ = 0, done_ = 0;
  std::exception_ptr failure_;
  bool stopped_ = false;
};

void work(Board& board, std::span<const Acquisition> acquisitions, const fs::path& folder) try {
  while (const std::optional<std::size_t> index = board.take()) {
    const Job& job = board.job(*index);
    if (!find_result(folder, job)) {  // another program may have been faster
      const std::optional<JobResult> result = run_job(job, acquisitions, board.observer_of(*index));
      if (!result) return;
      write_result(folder, *result);
    }
    board.done(*index);
  }
} catch (...) {
  board.failed(std::current_exception());
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

std::vector<Job> without_result(std::span<const Job> jobs, const fs::path& folder) {
  std::vector<Job> left;
  for (const Job& job : jobs)
    if (!find_result(folder, job)) left.push_back(job);
  return left;
}

bool run_jobs(std::span<const Job> jobs, std::span<const Acquisition> acquisitions, const fs::path& folder,
              int workers, const RunObserver& observer) {
  assert(workers >= 1);
  make_results_folder(folder);
  remove_litter(folder);
  if (!jobs.empty()) require_label(jobs.front().label, folder);
  std::vector<Job> left = without_result(jobs, folder);
  const std::size_t threads = std::min(static_cast<std::size_t>(workers), left.size());
  const std::size_t reused = jobs.size() - left.size();
  Board board(std::move(left), reused, observer);
  std::vector<std::jthread> team;
  for (std::size_t i = 0; i < threads; ++i) team.emplace_back([&] { work(board, acquisitions, folder); });
  team.clear();  // waits for them
  return board.concluded();
}

}  // namespace thermorig::study
