// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "thermorig/core/time.h"

namespace thermorig::rig {

enum class SyncWhen : std::uint8_t { each_frame, period, end };

/// When a journal that is being written is synced to the disk: what a loss of power may cost.
struct SyncPolicy {
  SyncWhen when = SyncWhen::period;
  HostDuration period = std::chrono::milliseconds(
      125);  // so much is lost at most; with each_frame: of what comes between frames
};

/// "frame", "end", or milliseconds from 10 to 60000. Throws Error(bad_usage).
SyncPolicy sync_policy_from(const std::string& text);

/// What sync_policy_from() reads: "frame", "125", "end".
std::string to_text(const SyncPolicy& policy);

}  // namespace thermorig::rig
