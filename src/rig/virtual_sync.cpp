// SPDX-License-Identifier: MIT
#include "virtual_sync.h"

#include "journal_sync.h"

namespace thermorig::rig {

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
