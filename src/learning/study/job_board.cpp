// SPDX-License-Identifier: MIT
#include "job_board.h"

#include <limits>

namespace thermorig::study {

namespace {

double work_of(const Job& job) {
  network::Shape shape;
  shape.frames = job.frames;
  shape.reduction = job.reduction;
  shape.fusion = job.fusion;
  return static_cast<double>(network::multiply_adds(shape)) * job.epochs;
}

}  // namespace

JobBoard::JobBoard(std::vector<Job> jobs, std::size_t reused, const RunObserver& observer)
    : jobs_(std::move(jobs)),
      reused_(reused),
      observer_(observer),
      begin_(std::chrono::steady_clock::now()),
      share_(jobs_.size(), 0.0) {
  if (observer_.started) observer_.started(progress(jobs_.size()));
}

std::optional<std::size_t> JobBoard::take() {
  const std::lock_guard lock(mutex_);
  if (next_ == jobs_.size() || stopping_locked()) return std::nullopt;
  return next_++;
}

void JobBoard::epoch_done(std::size_t index, int epoch) {
  const std::lock_guard lock(mutex_);
  share_[index] = static_cast<double>(epoch) / jobs_[index].epochs;
  if (observer_.epoch_done) observer_.epoch_done(progress(index));
}

void JobBoard::job_done(std::size_t index) {
  const std::lock_guard lock(mutex_);
  share_[index] = 1.0;
  ++done_;
  if (observer_.job_done) observer_.job_done(progress(index));
}

void JobBoard::failed(const std::exception_ptr& failure) {
  const std::lock_guard lock(mutex_);
  if (!failure_) failure_ = failure;
}

bool JobBoard::stopping() {
  const std::lock_guard lock(mutex_);
  return stopping_locked();
}

bool JobBoard::stopping_locked() {
  if (!stopped_ && observer_.stop) stopped_ = observer_.stop();
  return stopped_ || failure_;
}

bool JobBoard::concluded() {
  if (failure_) std::rethrow_exception(failure_);
  return done_ == jobs_.size();
}

Progress JobBoard::progress(std::size_t index) const {
  double all = 0.0, done = 0.0;
  for (std::size_t i = 0; i < jobs_.size(); ++i) {
    all += work_of(jobs_[i]);
    done += work_of(jobs_[i]) * share_[i];
  }
  Progress progress;
  progress.all = reused_ + jobs_.size();
  progress.done = reused_ + done_;
  progress.reused = reused_;
  progress.share = all > 0.0 ? done / all : 1.0;
  progress.elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  progress.eta_s = progress.share > 0.0 ? progress.elapsed_s * (1.0 - progress.share) / progress.share
                                        : std::numeric_limits<double>::quiet_NaN();
  if (index < jobs_.size()) progress.last = description_of(jobs_[index]);
  return progress;
}

}  // namespace thermorig::study
