// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <exception>
#include <filesystem>
#include <memory>
#include <mutex>
#include <vector>

#include "thermorig/learning/study/study.h"

namespace thermorig::study {

/// A job that this run has claimed.
struct TakenJob {
  std::size_t index = 0;
  std::unique_ptr<files::BeatingClaim> claim;
};

/// Which jobs of a run are waiting, running and done, for its workers: every function may be called from any
/// of them, and the observer is called by one at a time. Other programs may run jobs of the same folder.
class JobBoard {
 public:
  /// `jobs`: those that are left to be run, in their order. `reused`: how many others have a result.
  JobBoard(const std::vector<Job>& jobs, std::size_t reused, std::filesystem::path folder,
           const RunObserver& observer, const files::ClaimTiming& timing);

  /// The next job to run, claimed. Waits while other programs hold all that is left. None when every job has
  /// a result or is run by this program, or the run was stopped or has failed. Throws as find_result() and
  /// Claim::take().
  std::optional<TakenJob> take();
  const Job& job(std::size_t index) const { return places_[index].job; }

  void epoch_done(std::size_t index, int epoch);
  void job_done(std::size_t index);
  /// Another program has taken the job over.
  void lost(std::size_t index);
  void failed(const std::exception_ptr& failure);  // the first is kept

  /// Is the run to end before its jobs are done?
  bool stopping();

  /// After all workers have ended: throws what failed first; were all jobs done?
  bool concluded();

 private:
  using Time = std::chrono::steady_clock::time_point;
  enum class State : std::uint8_t { open, running, done };

  /// A job, and what is known of it.
  struct Place {
    Job job;
    State state = State::open;
    double share = 0.0;  // of its work that is done
    files::ClaimWatch watch;
    files::ClaimSight claim;  // of another program, when it was looked at
    Time next_look{};
    int told = 0;  // number of the claim that the observer knows of
  };

  std::optional<TakenJob> take_any(Time now);
  std::unique_ptr<files::BeatingClaim> claim(Place& place, Time now);
  bool is_any_open() const;
  void tell_of_holders();
  bool take_result(Place& place);
  void done_locked(Place& place);
  bool stopping_locked();
  Progress progress(const Job* last) const;

  std::vector<Place> places_;
  std::size_t reused_;
  std::filesystem::path folder_;
  const RunObserver& observer_;
  files::ClaimTiming timing_;
  Time begin_;

  std::mutex mutex_;
  std::size_t done_ = 0;
  std::exception_ptr failure_;
  bool stopped_ = false;
};

}  // namespace thermorig::study
