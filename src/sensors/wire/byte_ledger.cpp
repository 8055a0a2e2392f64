// SPDX-License-Identifier: MIT
#include "thermorig/sensors/wire/byte_ledger.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace thermorig::wire {

void ByteLedger::receive(std::size_t bytes) {
  counters.bytes_received += bytes;
  counters.bytes_pending += bytes;
}

void ByteLedger::restart() {
  position_ = damage_end_ = counters.bytes_received;
  in_gap_ = gap_ = false;
}

void ByteLedger::advance(std::size_t bytes) {
  assert(bytes <= waiting());
  counters.bytes_pending -= bytes;
  position_ += bytes;
}

StreamSpan ByteLedger::book_message(std::size_t bytes) {
  const std::uint64_t begin = position_;
  advance(bytes);
  counters.bytes_in_messages += bytes;
  damage_end_ = position_;
  in_gap_ = false;
  return {begin, position_};
}

void ByteLedger::book_reply(std::size_t bytes) {
  book_message(bytes);
  ++counters.replies;
}

void ByteLedger::mark_damage(std::size_t bytes) {
  damage_end_ = position_ + bytes;
}

void ByteLedger::book_gap(std::size_t bytes) {
  const std::uint64_t marked = in_damage() ? damage_end_ - position_ : 0;
  const std::uint64_t damaged = std::min<std::uint64_t>(bytes, marked);
  advance(bytes);
  counters.bytes_in_damaged += damaged;
  counters.bytes_skipped += bytes - damaged;
  if (!in_gap_) ++counters.resyncs;
  in_gap_ = true;
  gap_ = true;
}

void ByteLedger::book_damaged(std::uint64_t Counters::*reason, std::size_t bytes) {
  ++(counters.*reason);
  mark_damage(bytes);
  book_gap(bytes);
}

void ByteLedger::book_filler(std::size_t bytes) {
  advance(bytes);
  counters.bytes_skipped += bytes;
  counters.bytes_in_filler += bytes;
}

bool ByteLedger::take_gap() {
  return std::exchange(gap_, false);
}

}  // namespace thermorig::wire
