// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "recording_columns.h"

namespace thermorig::session {

// What can be read from the bytes that the host sent to the servo.

/// Each answer with the time at which its ping was written, found by the token.
std::vector<PingExchange> ping_exchanges(const std::vector<TimedPong>& pongs, const RawStream& sent);

/// Everything that was to make the servo do something, in words.
std::vector<TimedCommand> timed_commands(const RawStream& sent);

}  // namespace thermorig::session
