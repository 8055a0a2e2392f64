// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace thermorig::wire {

/// What became of every byte of one port, and how many messages came of them.
/// bytes_received == bytes_in_messages + bytes_in_damaged + bytes_skipped + bytes_pending, always.
struct Counters {
  std::uint64_t bytes_received = 0;
  std::uint64_t bytes_in_messages = 0;  // in good messages of any kind
  std::uint64_t bytes_in_damaged = 0;   // in messages that were recognised but failed their check
  std::uint64_t bytes_skipped = 0;      // between messages: garbage, banners, the tail of a message
  std::uint64_t bytes_pending = 0;      // waiting for the rest of a message

  std::uint64_t messages = 0;  // good messages that carry data (frames, samples, telemetry)
  std::uint64_t replies = 0;   // other good messages (emissivity reply, acc packet, ack, pong)
  std::uint64_t bad_checksum = 0;
  std::uint64_t bad_length = 0;  // a length or size field that this device never sends
  std::uint64_t bad_value = 0;   // a line or field that cannot be read as numbers, not finite
  std::uint64_t lost = 0;     // messages that sequence numbers, or gaps in a steady rate, show to be missing
  std::uint64_t resyncs = 0;  // times that bytes were skipped to find the next message
  // Not stored:
  std::uint64_t layout_changes = 0;   // of lines of text: times that they went on with other columns
  std::uint64_t bytes_in_filler = 0;  // of those skipped: lines and packets of other kinds, sound as they are
  bool operator==(const Counters&) const = default;
};

}  // namespace thermorig::wire
