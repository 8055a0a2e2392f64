// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/learning/interchange/sink.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::interchange {

/// How the chunks of an MCAP file are stored.
enum class McapCompression { none, zstd };

/// The session as MCAP (https://mcap.dev/spec), messages in JSON, in order of time: /camera, /gyro, /servo,
/// /label, /events, and /shaft where something measured it. Chunked and indexed. Throws as the sink does.
void write_mcap(const session::Session& session, Sink& sink,
                McapCompression compression = McapCompression::none);

}  // namespace thermorig::interchange
