// SPDX-License-Identifier: MIT
#pragma once

#include "live_messages.h"
#include "options.h"
#include "thermorig/rig/recording.h"

namespace thermorig::app {

/// What the command line and the plan say of a run, before it has begun.
LiveFacts live_facts(LiveMode mode, const RecordOptions& options, const rig::RecordingOptions& recording);

/// How a recording's end is told.
LiveEnd end_of(const rig::RecordingResult& result);
LiveEnd end_of(const Error& error);

}  // namespace thermorig::app
