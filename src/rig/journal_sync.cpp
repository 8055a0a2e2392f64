// SPDX-License-Identifier: MIT
#include "journal_sync.h"

#include <chrono>

namespace thermorig::rig {

namespace {
constexpr auto sync_period = std::chrono::milliseconds(125);
}

JournalSync::JournalSync(journal::JournalWriter& journal) : journal_(journal), thread_([this] { run(); }) {}

JournalSync::~JournalSync() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void JournalSync::run() {
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, sync_period, [this] { return stop_; })) {
    lock.unlock();
    std::exception_ptr failure;
    try {
      journal_.sync();
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    if (failure) {
      failure_ = failure;
      return;
    }
  }
}

void JournalSync::check() {
  const std::lock_guard lock(mutex_);
  if (failure_) std::rethrow_exception(failure_);
}

}  // namespace thermorig::rig
