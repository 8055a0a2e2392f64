// SPDX-License-Identifier: MIT
#pragma once

#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "disk_watch.h"
#include "thermorig/storage/journal/journal.h"

namespace thermorig::rig {

/// When the next sync has to begin so that it ends within the period, counted from the begin of the one
/// before; `expected`: what it takes. At least a quarter of the period lies in between.
HostDuration pause_before_sync(HostDuration period, HostDuration expected);

/// What the next sync is expected to take when the last one took `lasted`: a slow one is not forgotten at
/// once.
HostDuration expected_sync(HostDuration expected, HostDuration lasted);

/// Syncs a journal on a thread of its own, each period anew, so that the reading thread never waits for the
/// disk. Nothing is handed over, so there is no queue between the two.
class JournalSync {
 public:
  JournalSync(journal::JournalWriter& journal, HostDuration period);
  ~JournalSync();  // waits for a sync that is under way
  JournalSync(const JournalSync&) = delete;
  JournalSync& operator=(const JournalSync&) = delete;

  /// Throws what a sync threw. Of the syncs since the last call that ended later than was promised, the one
  /// with the longest wait.
  std::optional<LateSync> check();

 private:
  void note_late(const LateSync& sync);
  void run();

  journal::JournalWriter& journal_;
  HostDuration period_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stop_ = false;
  HostDuration expected_{};  // what a sync may take, by those before
  std::optional<LateSync> late_;
  std::exception_ptr failure_;
  std::thread thread_;  // last: it uses everything above
};

}  // namespace thermorig::rig
