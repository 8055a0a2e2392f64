// SPDX-License-Identifier: MIT
#include "thermorig/core/run_all.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace thermorig {

namespace {

/// Numbers are taken in order, and who has taken one does it: so the lowest that fails is always the same.
class Sharing {
 public:
  Sharing(std::size_t count, const std::function<void(std::size_t)>& work)
      : work_(work), count_(count), failed_(count) {}

  void take_part() {
    for (std::size_t i = next_++; i < count_ && i < failed_; i = next_++) {
      try {
        work_(i);
      } catch (...) {
        note_failure(i);
      }
    }
  }

  void require_success() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  void note_failure(std::size_t number) {
    const std::lock_guard lock(mutex_);
    if (number > failed_) return;
    failed_ = number;
    failure_ = std::current_exception();
  }

  const std::function<void(std::size_t)>& work_;
  const std::size_t count_;
  std::atomic<std::size_t> next_{0};
  std::atomic<std::size_t> failed_;  // the lowest number; `count_`: none
  std::mutex mutex_;
  std::exception_ptr failure_;
};

}  // namespace

void on_all_cores(std::size_t count, const std::function<void(std::size_t)>& work) {
  Sharing sharing(count, work);
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
  {
    std::vector<std::jthread> others;
    for (std::size_t i = 1; i < std::min(cores, count); ++i)
      others.emplace_back([&sharing] { sharing.take_part(); });
    sharing.take_part();
  }
  sharing.require_success();
}

}  // namespace thermorig
