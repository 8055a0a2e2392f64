// SPDX-License-Identifier: MIT
#pragma once

#include "options.h"
#include "thermorig/core/error.h"

namespace thermorig::app {

/// `live --replay`: a session's raw chunks, in the order in which they came, through the causal pipeline and
/// the same rows, at a speed of the user's. Throws Error(not_a_session).
ExitCode replay_live(const LiveOptions& options);

}  // namespace thermorig::app
