// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "recording_columns.h"

namespace thermorig::session {

// The bytes that the host sent to the devices, and what can be read from those to the servo.

/// The name of their group in /raw. Older sessions have that of the servo alone; another device's is there if
/// anything was sent to it.
std::string sent_group(Device to);

/// Each answer with the time at which its ping was written, found by the token.
std::vector<PingExchange> ping_exchanges(const std::vector<TimedPong>& pongs, const RawStream& sent);

/// Everything that was to make the servo do something, in words.
std::vector<TimedCommand> timed_commands(const RawStream& sent);

}  // namespace thermorig::session
