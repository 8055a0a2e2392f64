// SPDX-License-Identifier: MIT
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "thermorig/sensors/wire/byte_ledger.h"
#include "thermorig/sensors/wire/reassembly.h"

namespace thermorig::sensors {

/// What a frame with a good check sum turns out to be.
enum class FrameKind : std::uint8_t { sample, reply, bad_length, bad_value };

/// Finds the frames of a protocol in which each has a mark in front, its length, and a check sum. `Framing`
/// says how:
///
///   sync        the first byte of each frame
///   longest     bytes of the longest frame
///   size(rest)  of the frame that `rest` begins with, as far as its length says; 0: more bytes are needed;
///               none: no frame begins here
///   is_good(frame)     its check sum fits
///   is_proof(frame)    it is so well checked that it needs no other one behind it to be believed
///   read(frame)        what it holds, as a Framing::Content; may keep what later frames need
///   restart()          forgets that
///
/// `Content` has a `kind`, and append_to(messages, span, gap) adds what it holds for the program: gap is
/// whether bytes were skipped before a sample.
///
/// A frame that is not good is left byte by byte, so that one whose length was damaged hides none behind it.
/// Bad ones count as bad_checksum where the frame before was good: elsewhere the mark may be other data.
template <typename Framing>
class FramedScanner {
 public:
  using Message = typename Framing::Content::Message;

  explicit FramedScanner(Framing framing) : framing_(std::move(framing)) {}

  void push(wire::Bytes bytes, std::vector<Message>& out) {
    assert(!ended_);
    ledger_.receive(bytes.size());
    wire::reassemble(pending_, bytes, Framing::longest + 1,
                     [&](wire::Bytes rest) { return step(rest, out); });
    assert(pending_.size() == ledger_.waiting());
  }
  void finish(std::vector<Message>& out) {
    ended_ = true;
    wire::reassemble_end(pending_, [&](wire::Bytes rest) { return step(rest, out); });
    assert(pending_.size() == ledger_.waiting());
  }
  void restart() {
    ledger_.restart();
    pending_.clear();
    framing_.restart();
    locked_ = ended_ = false;
  }
  const wire::Counters& counters() const { return ledger_.counters; }
  const Framing& framing() const { return framing_; }
  Framing& framing() { return framing_; }

 private:
  using Kind = FrameKind;

  std::size_t step(wire::Bytes rest, std::vector<Message>& out) {
    if (rest[0] != Framing::sync) return skip(wire::bytes_before(Framing::sync, rest));
    const std::optional<std::size_t> size = Framing::size(rest);
    if (!size) return skip(1);
    if (*size == 0 || rest.size() < *size) return wait(rest);
    const wire::Bytes frame = rest.first(*size);
    if (!Framing::is_good(frame)) return refuse(*size);
    if (!locked_ && !Framing::is_proof(frame)) {
      if (rest.size() == *size && !ended_) return 0;
      if (rest.size() > *size && rest[*size] != Framing::sync) return skip(1);
    }
    return take(frame, out);
  }

  /// For the rest of a frame. At the end of the stream none comes, and good ones may stand behind a length
  /// that was damaged.
  std::size_t wait(wire::Bytes rest) {
    if (!ended_) return 0;
    return locked_ && !holds_frame(rest.subspan(1)) ? 0 : skip(1);
  }

  static bool holds_frame(wire::Bytes bytes) {
    for (; !bytes.empty(); bytes = bytes.subspan(1)) {
      const auto size = bytes[0] == Framing::sync ? Framing::size(bytes) : std::nullopt;
      if (size && *size > 0 && *size <= bytes.size() && Framing::is_good(bytes.first(*size))) return true;
    }
    return false;
  }

  std::size_t take(wire::Bytes frame, std::vector<Message>& out) {
    locked_ = true;
    typename Framing::Content content = framing_.read(frame);
    if (content.kind == Kind::bad_length || content.kind == Kind::bad_value) {
      ++(content.kind == Kind::bad_length ? ledger_.counters.bad_length : ledger_.counters.bad_value);
      ledger_.mark_damage(frame.size());
      ledger_.book_gap(frame.size());
      return frame.size();
    }
    const StreamSpan span = ledger_.book_message(frame.size());
    ++(content.kind == Kind::reply ? ledger_.counters.replies : ledger_.counters.messages);
    const bool gap = content.kind == Kind::sample && ledger_.take_gap();
    std::move(content).append_to(out, span, gap);
    return frame.size();
  }

  std::size_t refuse(std::size_t size) {
    if (locked_) {
      ++ledger_.counters.bad_checksum;
      ledger_.mark_damage(size);
    }
    return skip(1);
  }

  std::size_t skip(std::size_t bytes) {
    locked_ = false;
    ledger_.book_gap(bytes);
    return bytes;
  }

  Framing framing_;
  wire::ByteLedger ledger_;
  std::vector<std::uint8_t> pending_;  // received, not yet booked
  bool locked_ = false;                // the frames before came in a row
  bool ended_ = false;
};

}  // namespace thermorig::sensors
