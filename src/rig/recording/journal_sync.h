// SPDX-License-Identifier: MIT
#pragma once

#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "disk_watch.h"
#include "thermorig/rig/recording/sync_policy.h"
#include "thermorig/storage/journal/journal.h"

namespace thermorig::rig {

/// When the next sync has to begin so that it ends within the period, counted from the begin of the one
/// before; `expected`: what it takes. At least a quarter of the period lies in between.
HostDuration pause_before_sync(HostDuration period, HostDuration expected);

/// What the next sync is expected to take when the last one took `lasted`: a slow one is not forgotten at
/// once.
HostDuration expected_sync(HostDuration expected, HostDuration lasted);

/// Syncs a journal on a thread of its own, so that the reading thread never waits for the disk. Nothing is
/// handed over but the word that there is a frame, so there is no queue between the two.
class JournalSync {
 public:
  /// `policy` is not SyncWhen::end: that needs none of this.
  JournalSync(journal::JournalWriter& journal, const SyncPolicy& policy);
  ~JournalSync();  // waits for a sync that is under way
  JournalSync(const JournalSync&) = delete;
  JournalSync& operator=(const JournalSync&) = delete;

  /// A frame has been appended: with SyncWhen::each_frame it is synced now.
  void frame();

  /// Throws what a sync threw.
  void check();

  /// Of the syncs that ended later than was promised, the one with the longest wait; none if there was none,
  /// or it was told before.
  std::optional<LateSync> take_late();

 private:
  void note_late(const LateSync& sync);
  void run();
  void wait_for_turn(std::unique_lock<std::mutex>& lock, std::chrono::steady_clock::time_point begin);

  journal::JournalWriter& journal_;
  SyncPolicy policy_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stop_ = false;
  bool has_frame_ = false;
  HostDuration expected_{};  // what a sync may take, by those before
  std::optional<LateSync> late_;
  std::exception_ptr failure_;
  std::thread thread_;  // last: it uses everything above
};

/// Syncs a journal by the recording's own clock, in line: for recordings in virtual time, where all that
/// happens has to happen again in the same order.
class VirtualSync {
 public:
  VirtualSync(journal::JournalWriter& journal, const SyncPolicy& policy, HostTime begin);

  void frame() { has_frame_ = true; }
  void tick(HostTime now);  // throws Error(storage)

 private:
  journal::JournalWriter& journal_;
  SyncPolicy policy_;
  HostTime last_;
  bool has_frame_ = false;
};

}  // namespace thermorig::rig
