// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "thermorig/storage/session/session.h"

namespace thermorig::session {

/// Of a frame: what the figures of its stream are made of.
struct FrameMark {
  HostTime time{};
  HostTime arrival{};
  std::uint16_t fresh_even = 0, fresh_odd = 0, missing_before = 0;
};

/// Of all messages: a small part of them.
struct MessageMarks {
  std::vector<FrameMark> frames;
  std::vector<HostTime> gyro, servo;  // times
};

/// What quality_of(session) says of a session whose messages are these.
Quality quality_of(const Session& session, const MessageMarks& marks);

}  // namespace thermorig::session
