// SPDX-License-Identifier: MIT
#include "journal_sync.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace thermorig::rig {

using Clock = std::chrono::steady_clock;

HostDuration pause_before_sync(HostDuration period, HostDuration expected) {
  const HostDuration margin = period / 8;  // for a sync that takes a little longer than was expected
  return std::max(period - expected - margin, period / 4);
}

HostDuration expected_sync(HostDuration expected, HostDuration lasted) {
  return std::max(lasted, expected - expected / 32);
}

JournalSync::JournalSync(journal::JournalWriter& journal, HostDuration period)
    : journal_(journal), period_(period), thread_([this] { run(); }) {}

JournalSync::~JournalSync() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void JournalSync::run() {
  Clock::time_point begin = Clock::now();
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait_until(lock, begin + pause_before_sync(period_, expected_), [this] { return stop_; });
    if (stop_) return;
    lock.unlock();
    const Clock::time_point oldest = std::exchange(begin, Clock::now());  // byte that this sync is for
    std::exception_ptr failure;
    try {
      journal_.sync();
    } catch (...) {
      failure = std::current_exception();
    }
    const Clock::time_point end = Clock::now();
    lock.lock();
    const LateSync sync{.waited = std::chrono::duration_cast<HostDuration>(end - oldest),
                        .lasted = std::chrono::duration_cast<HostDuration>(end - begin)};
    expected_ = expected_sync(expected_, sync.lasted);
    if (sync.waited > period_) note_late(sync);
    failure_ = failure;
    if (failure) return;
  }
}

/// The worst of each: the longest wait may not hide a slow sync.
void JournalSync::note_late(const LateSync& sync) {
  if (!late_) late_ = sync;
  late_->waited = std::max(late_->waited, sync.waited);
  late_->lasted = std::max(late_->lasted, sync.lasted);
}

std::optional<LateSync> JournalSync::check() {
  const std::lock_guard lock(mutex_);
  if (failure_) std::rethrow_exception(failure_);
  return std::exchange(late_, std::nullopt);
}

}  // namespace thermorig::rig
