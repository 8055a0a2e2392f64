// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "recording_columns.h"

namespace thermorig::session {

/// Each answer with the time at which its ping was written, found by the token in the bytes that were sent.
std::vector<PingExchange> ping_exchanges(const std::vector<TimedPong>& pongs, const RawStream& sent);

}  // namespace thermorig::session
