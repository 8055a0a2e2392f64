// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/learning/interchange/sink.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::interchange {

/// The session as MCAP (https://mcap.dev/spec), messages in JSON, in order of time: /camera, /gyro, /servo,
/// /label, /events. Chunked, indexed, not compressed. Throws as the sink does.
void write_mcap(const session::Session& session, Sink& sink);

}  // namespace thermorig::interchange
