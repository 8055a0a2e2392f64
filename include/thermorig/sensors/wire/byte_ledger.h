// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "thermorig/core/chunk.h"
#include "thermorig/sensors/wire/counters.h"

namespace thermorig::wire {

/// Books every byte of a stream exactly once, in stream order, so that the sum in counters.h always holds.
/// Scanners read bytes ahead as they like and book them when their fate is known.
class ByteLedger {
 public:
  Counters counters;

  /// `bytes` more have come in and wait to be booked.
  void receive(std::size_t bytes);

  /// Bytes that have come in and are not booked yet.
  std::uint64_t waiting() const { return counters.bytes_received - position_; }

  /// The stream was interrupted here: what waits stays pending for ever, and the next byte begins anew.
  void restart();

  /// The next `bytes` are a good message. Returns where it stands.
  StreamSpan book_message(std::size_t bytes);

  /// The same of `message`, which carries data: it learns where it stands and whether there was a gap before.
  template <typename Message>
  void book_data(Message& message, std::size_t bytes) {
    message.resync_before = take_gap();
    message.span = book_message(bytes);
    ++counters.messages;
  }

  /// The same of a message that carries none.
  void book_reply(std::size_t bytes);

  /// The next `bytes` belong to a damaged message, as far as no good message is found among them.
  void mark_damage(std::size_t bytes);
  bool in_damage() const { return position_ < damage_end_; }

  /// The next `bytes` belong to no good message: damaged where they are marked so, else skipped.
  void book_gap(std::size_t bytes);

  /// The next `bytes` are a message that is none, for a reason that has its count.
  void book_damaged(std::uint64_t Counters::*reason, std::size_t bytes);

  /// The next `bytes` carry nothing and are no sign of trouble (idle flags, other lines of text): skipped.
  void book_filler(std::size_t bytes);

  /// Whether there was a gap since the last call.
  bool take_gap();

 private:
  void advance(std::size_t bytes);

  std::uint64_t position_ = 0;    // stream offset of the first byte that is not booked yet
  std::uint64_t damage_end_ = 0;  // stream offset one past the damaged message
  bool in_gap_ = false;           // the byte before position_ lies in a gap
  bool gap_ = false;
};

}  // namespace thermorig::wire
