// SPDX-License-Identifier: MIT
#pragma once

#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

#include "thermorig/journal/journal.h"

namespace thermorig::rig {

/// Syncs a journal about eight times a second on a thread of its own, so that a loss of power costs an eighth
/// of a second and the reading thread never waits for the disk. The work comes by the clock, not by the byte:
/// the reading thread hands nothing over, so there is no queue between the two.
class JournalSync {
 public:
  explicit JournalSync(journal::JournalWriter& journal);
  ~JournalSync();  // waits for a sync that is under way
  JournalSync(const JournalSync&) = delete;
  JournalSync& operator=(const JournalSync&) = delete;

  /// Throws what a sync threw.
  void check();

 private:
  void run();

  journal::JournalWriter& journal_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stop_ = false;
  std::exception_ptr failure_;
  std::thread thread_;  // last: it uses everything above
};

}  // namespace thermorig::rig
