// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "thermorig/core/chunk.h"
#include "thermorig/core/frame.h"
#include "thermorig/core/freshness.h"
#include "thermorig/core/profile.h"
#include "thermorig/sensors/wire/byte_ledger.h"
#include "thermorig/sensors/wire/counters.h"

namespace thermorig::wire {

struct CameraMessage {
  ThermalFrame frame;
  Freshness fresh;  // against the message before
  StreamSpan span;
  bool resync_before = false;  // bytes were skipped or damaged since the message before
};

/// Finds GY-MCU90640 frames in a stream of bytes: header, length, signed temperatures, check sum. Any
/// chunking gives the same frames. Source: protocols/gy_mcu90640.md.
///
/// A reply that the bridge puts between two bytes of a frame is found by the check sum: both count, and the
/// span of the frame holds the reply.
///
/// With ChecksumPolicy::ignore a frame is taken only when the next frame or reply starts right behind it, or
/// the stream ends there, so the newest frame waits for the header of the next one.
class CameraScanner {
 public:
  explicit CameraScanner(ChecksumPolicy checksum = ChecksumPolicy::word);

  /// Takes the next bytes of the stream and appends the frames that they complete to `out`.
  void push(std::span<const std::uint8_t> bytes, std::vector<CameraMessage>& out);

  /// The stream ends here: what only waits for the bytes behind it is decided.
  void finish(std::vector<CameraMessage>& out);

  /// After finish(): the stream was interrupted, and what comes next is a stream anew. Spans and counters go
  /// on.
  void restart();

  const Counters& counters() const { return ledger_.counters; }

 private:
  using Bytes = std::span<const std::uint8_t>;

  std::size_t step(Bytes rest, std::vector<CameraMessage>& out);
  std::size_t take_frame(Bytes rest, std::vector<CameraMessage>& out);
  std::size_t book_frame(Bytes frame, std::size_t bytes, std::vector<CameraMessage>& out);
  std::size_t take_interrupted_frame(Bytes bytes, std::size_t reply_at, std::vector<CameraMessage>& out);
  std::size_t take_reply();
  std::size_t skip(std::size_t bytes);
  bool is_start_or_end(Bytes rest) const;

  ChecksumPolicy checksum_;
  ByteLedger ledger_;
  FreshnessDetector<std::int16_t> freshness_;
  std::vector<std::uint8_t> pending_;  // received, not yet booked
  bool ended_ = false;
};

}  // namespace thermorig::wire
