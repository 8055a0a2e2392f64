// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/journal/journal.h"
#include "thermorig/rig/sync_policy.h"

namespace thermorig::rig {

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
