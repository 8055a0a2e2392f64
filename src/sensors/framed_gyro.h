// SPDX-License-Identifier: MIT
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "text_words.h"
#include "thermorig/sensors/gyro_protocol.h"
#include "thermorig/sensors/wire/byte_ledger.h"
#include "thermorig/sensors/wire/reassembly.h"

namespace thermorig::sensors {

/// What a frame with a good check sum turns out to hold.
struct FrameContent {
  enum class Kind : std::uint8_t { sample, reply, bad_length, bad_value };
  Kind kind = Kind::reply;
  GyroReading reading = {};  // of a sample

  static FrameContent bad(Kind why) { return {.kind = why}; }
};

/// A sample; a value that cannot be used where a rate is infinite or not a number, or the time is before 0.
inline FrameContent sample_or_bad_value(const GyroReading& reading) {
  const bool is_finite = std::all_of(reading.rate_dps.begin(), reading.rate_dps.end(),
                                     [](float rate_dps) { return std::isfinite(rate_dps); });
  if (!is_finite || reading.device_time_us.value_or(0) < 0)
    return FrameContent::bad(FrameContent::Kind::bad_value);
  return {.kind = FrameContent::Kind::sample, .reading = reading};
}

/// Finds the frames of a protocol in which each has a mark in front, its length, and a check sum. `Framing`
/// says how:
///
///   sync        the first byte of each frame
///   longest     bytes of the longest frame
///   size(rest)  of the frame that `rest` begins with, as far as its length says; 0: more bytes are needed;
///               none: no frame begins here
///   is_good(frame)     its check sum fits
///   is_proof(frame)    it is so well checked that it needs no other one behind it to be believed
///   read(frame)        what it holds; may keep what later frames need
///   restart()          forgets that
///
/// A frame that is not good is left byte by byte, so that one whose length was damaged hides none behind it.
/// Bad ones count as bad_checksum where the frame before was good: elsewhere the mark may be other data.
template <typename Framing>
class FramedGyroScanner {
 public:
  explicit FramedGyroScanner(Framing framing) : framing_(std::move(framing)) {}

  void push(wire::Bytes bytes, std::vector<wire::GyroMessage>& out) {
    assert(!ended_);
    ledger_.receive(bytes.size());
    wire::reassemble(pending_, bytes, Framing::longest + 1,
                     [&](wire::Bytes rest) { return step(rest, out); });
    assert(pending_.size() == ledger_.waiting());
  }
  void finish(std::vector<wire::GyroMessage>& out) {
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

 private:
  using Kind = FrameContent::Kind;

  std::size_t step(wire::Bytes rest, std::vector<wire::GyroMessage>& out) {
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

  std::size_t take(wire::Bytes frame, std::vector<wire::GyroMessage>& out) {
    locked_ = true;
    const FrameContent content = framing_.read(frame);
    if (content.kind == Kind::bad_length || content.kind == Kind::bad_value) {
      ++(content.kind == Kind::bad_length ? ledger_.counters.bad_length : ledger_.counters.bad_value);
      ledger_.mark_damage(frame.size());
      ledger_.book_gap(frame.size());
      return frame.size();
    }
    const StreamSpan span = ledger_.book_message(frame.size());
    if (content.kind == Kind::reply) {
      ++ledger_.counters.replies;
      return frame.size();
    }
    out.push_back({content.reading, span, ledger_.take_gap()});
    ++ledger_.counters.messages;
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

/// What the scanner finds in bytes that are looked at once: its counters, and what `Framing` has kept.
template <typename Framing>
FramedGyroScanner<Framing> scanned(Framing framing, wire::Bytes bytes) {
  FramedGyroScanner<Framing> scanner(std::move(framing));
  std::vector<wire::GyroMessage> messages;
  scanner.push(bytes, messages);
  scanner.finish(messages);
  return scanner;
}

/// Evidence of a protocol: nothing where fewer than two frames are good. `frames`: what they are called.
/// `without_rates`: what to try where none of them holds rates.
inline std::optional<Evidence> framed_evidence(const wire::Counters& counters, std::string_view frames,
                                               std::string_view held, std::string without_rates) {
  const std::uint64_t good = counters.messages + counters.replies;
  if (good < 2) return std::nullopt;
  Evidence evidence{.messages = counters.messages,
                    .bytes = counters.bytes_in_messages,
                    .text = fmt::format("{} {}, {} of a gyro", good, frames, counters.messages),
                    .text_format = {}};
  if (counters.messages > 0) return evidence;
  evidence.text = fmt::format("no rates of turn among {} good {}{}", good, frames, held);
  evidence.advice = std::move(without_rates);
  return evidence;
}

/// All of the bytes as one number, the first being the highest.
inline std::uint64_t big_endian(wire::Bytes bytes) {
  std::uint64_t number = 0;
  for (const std::uint8_t byte : bytes) number = number << 8U | byte;
  return number;
}
inline float big_endian_float(wire::Bytes bytes) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(big_endian(bytes.first(4))));
}

}  // namespace thermorig::sensors
