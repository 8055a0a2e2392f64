// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <exception>
#include <mutex>
#include <vector>

#include "thermorig/learning/study/study.h"

namespace thermorig::study {

/// Which jobs of a run are waiting, running and done, for its workers: every function may be called from any
/// of them, and the observer is called by one at a time.
class JobBoard {
 public:
  /// `jobs`: those that are left to be run, in their order. `reused`: how many others have a result.
  JobBoard(std::vector<Job> jobs, std::size_t reused, const RunObserver& observer);

  /// The next job to run; none when there is no other, or the run was stopped or has failed.
  std::optional<std::size_t> take();
  const Job& job(std::size_t index) const { return jobs_[index]; }

  void epoch_done(std::size_t index, int epoch);
  void job_done(std::size_t index);
  void failed(const std::exception_ptr& failure);  // the first is kept

  /// Is the run to end before its jobs are done?
  bool stopping();

  /// After all workers have ended: throws what failed first; were all jobs done?
  bool concluded();

 private:
  bool stopping_locked();
  Progress progress(std::size_t index) const;

  std::vector<Job> jobs_;
  std::size_t reused_;
  const RunObserver& observer_;
  std::chrono::steady_clock::time_point begin_;

  std::mutex mutex_;
  std::size_t next_ = 0, done_ = 0;
  std::vector<double> share_;  // of each job's work that is done
  std::exception_ptr failure_;
  bool stopped_ = false;
};

}  // namespace thermorig::study
