// SPDX-License-Identifier: MIT
#include "for_each_file.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace thermorig::dataset {

namespace {

/// Files are taken in order; one thread's file is read while others do theirs.
class Reading {
 public:
  Reading(std::size_t count, const std::function<void(std::size_t)>& work, const ReadingProgress& progress)
      : work_(work), progress_(progress), failures_(count) {}

  void take_files() {
    while (!failed_) {
      const std::size_t index = next_++;  // who has taken one reads it, so that the first failure is the same
      if (index >= failures_.size()) return;
      take(index);
    }
  }

  /// Throws what went wrong with the first of the files.
  void require_success() const {
    for (const std::exception_ptr& failure : failures_)
      if (failure) std::rethrow_exception(failure);
  }

 private:
  void take(std::size_t index) {
    try {
      work_(index);
      const std::lock_guard turn(progress_turn_);
      ++done_;
      if (progress_) progress_(done_, failures_.size());
    } catch (...) {
      failures_[index] = std::current_exception();
      failed_ = true;
    }
  }

  const std::function<void(std::size_t)>& work_;
  const ReadingProgress& progress_;
  std::vector<std::exception_ptr> failures_;  // one a file
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> failed_{false};
  std::mutex progress_turn_;
  std::size_t done_ = 0;
};

}  // namespace

void for_each_file(std::size_t count, const std::function<void(std::size_t)>& work,
                   const ReadingProgress& progress) {
  Reading reading(count, work, progress);
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
  std::vector<std::jthread> others;
  for (std::size_t i = 1; i < std::min(cores, count); ++i)
    others.emplace_back([&reading] { reading.take_files(); });
  reading.take_files();
  others.clear();  // waits for them
  reading.require_success();
}

}  // namespace thermorig::dataset
