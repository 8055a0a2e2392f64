// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "thermorig/core/chunk.h"

namespace thermorig::wire {

/// A frame that the host sent to the servo, read back from the bytes.
struct SentFrame {
  std::uint8_t type = 0;  // enum servo_type; 0 for the raw stop byte, which no frame carries
  std::uint8_t sequence = 0;
  std::vector<std::uint8_t> payload;  // of the length that its type has
  StreamSpan span;
};

/// The good frames and stop bytes in everything that was sent. Other bytes are passed over: the host's own
/// recording of what it sent has none.
std::vector<SentFrame> read_sent(std::span<const std::uint8_t> bytes);

/// The same, one after another.
void for_each_sent(std::span<const std::uint8_t> bytes, const std::function<void(const SentFrame&)>& take);

/// False for what the host sends by the clock (refresh, ping) rather than to make the servo do something.
bool is_command(const SentFrame& frame);

/// "run leg 3 at +90.00 deg/s, 2000 deg/s^2, for 7.70 s (sequence 12)".
std::string command_text(const SentFrame& frame);

}  // namespace thermorig::wire
