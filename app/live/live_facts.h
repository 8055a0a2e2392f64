// SPDX-License-Identifier: MIT
#pragma once

#include "live_messages.h"
#include "options.h"
#include "thermorig/rig/recording/recording.h"

namespace thermorig::app {

/// What the command line and the plan say of a run, before it has begun.
LiveFacts live_facts(LiveMode mode, const RecordOptions& options, const rig::RecordingOptions& recording);

/// How a recording's end is told.
LiveEnd end_of(const rig::RecordingResult& result);
LiveEnd end_of(const Error& error);

/// Runs `drive`; `watcher` is told how it ended, be it by an Error.
template <typename Watcher, typename Drive>
rig::RecordingResult told(Watcher& watcher, Drive drive) {
  try {
    rig::RecordingResult result = drive();
    watcher.ended(end_of(result));
    return result;
  } catch (const Error& error) {
    watcher.ended(end_of(error));
    throw;
  }
}

}  // namespace thermorig::app
