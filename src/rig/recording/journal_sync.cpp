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

JournalSync::JournalSync(journal::JournalWriter& journal, const SyncPolicy& policy)
    : journal_(journal), policy_(policy), thread_([this] { run(); }) {}

JournalSync::~JournalSync() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void JournalSync::frame() {
  if (policy_.when != SyncWhen::each_frame) return;
  {
    const std::lock_guard lock(mutex_);
    has_frame_ = true;
  }
  wake_.notify_one();
}

void JournalSync::wait_for_turn(std::unique_lock<std::mutex>& lock, Clock::time_point begin) {
  // With each_frame as well: a camera that sends nothing leaves the others' bytes to the period.
  wake_.wait_until(lock, begin + pause_before_sync(policy_.period, expected_),
                   [this] { return stop_ || has_frame_; });
}

void JournalSync::run() {
  Clock::time_point begin = Clock::now();
  std::unique_lock lock(mutex_);
  while (true) {
    wait_for_turn(lock, begin);
    if (stop_) return;
    const bool is_for_frame = std::exchange(has_frame_, false);
    lock.unlock();
    const Clock::time_point waiting_since =
        is_for_frame ? Clock::now() : begin;  // the oldest byte that this sync is for
    begin = Clock::now();
    std::exception_ptr failure;
    try {
      journal_.sync();
    } catch (...) {
      failure = std::current_exception();
    }
    const Clock::time_point end = Clock::now();
    lock.lock();
    const LateSync sync{.waited = std::chrono::duration_cast<HostDuration>(end - waiting_since),
                        .lasted = std::chrono::duration_cast<HostDuration>(end - begin)};
    expected_ = expected_sync(expected_, sync.lasted);
    if (sync.waited > policy_.period) note_late(sync);
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

void JournalSync::check() {
  const std::lock_guard lock(mutex_);
  if (failure_) std::rethrow_exception(failure_);
}

std::optional<LateSync> JournalSync::take_late() {
  const std::lock_guard lock(mutex_);
  return std::exchange(late_, std::nullopt);
}

VirtualSync::VirtualSync(journal::JournalWriter& journal, const SyncPolicy& policy, HostTime begin)
    : journal_(journal), policy_(policy), last_(begin) {}

void VirtualSync::tick(HostTime now) {
  const bool is_due = (policy_.when == SyncWhen::each_frame && has_frame_) ||
                      now - last_ >= pause_before_sync(policy_.period, HostDuration{});
  if (!is_due) return;
  journal_.sync();
  has_frame_ = false;
  last_ = now;
}

}  // namespace thermorig::rig
