// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "thermorig/core/chunk.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/reading.h"
#include "thermorig/wire/byte_ledger.h"
#include "thermorig/wire/counters.h"

namespace thermorig::wire {

struct GyroMessage {
  GyroReading reading;
  StreamSpan span;
  bool lost_before = false;  // bytes were skipped or damaged since the message before
};

/// Finds WitMotion packets in a stream of bytes; gyro packets become readings, others are counted as replies.
/// At the start and after damage it takes two good packets in a row to lock, or one at the end of the stream,
/// because one byte of sum is weak and the sync byte is common inside packets. Source:
/// protocols/witmotion.md.
class WitmotionScanner {
 public:
  void push(std::span<const std::uint8_t> bytes, std::vector<GyroMessage>& out);
  /// The stream ends here: what only waits for the bytes behind it is decided. The last call.
  void finish(std::vector<GyroMessage>& out);
  const Counters& counters() const { return ledger_.counters; }

 private:
  using Bytes = std::span<const std::uint8_t>;

  std::size_t step(Bytes rest, std::vector<GyroMessage>& out);
  std::size_t search(Bytes rest, std::vector<GyroMessage>& out);
  std::size_t take_packet(Bytes rest, std::vector<GyroMessage>& out);
  std::size_t skip(std::size_t bytes);

  ByteLedger ledger_;
  std::vector<std::uint8_t> pending_;  // received, not yet booked
  bool locked_ = false;                // the packets before came in a row
  bool ended_ = false;
};

/// Reads gyros that print one line of text a sample. Source: protocols/text_gyro.md.
///
/// Text has no checksum. What can be told from it is: without a prefix, the first line may be the tail of one
/// and is not read; a line with another number of fields than the lines before is damaged.
class TextGyroScanner {
 public:
  explicit TextGyroScanner(TextColumns columns);
  void push(std::span<const std::uint8_t> bytes, std::vector<GyroMessage>& out);
  const Counters& counters() const { return ledger_.counters; }

 private:
  using Bytes = std::span<const std::uint8_t>;

  std::size_t step(Bytes rest, std::vector<GyroMessage>& out);
  std::size_t skip_to_line_end(Bytes rest);
  void take_line(std::string_view line, std::size_t bytes, std::vector<GyroMessage>& out);
  bool has_usual_fields(std::size_t fields);

  TextColumns columns_;
  ByteLedger ledger_;
  std::vector<std::uint8_t> pending_;  // received, not yet booked
  bool at_line_start_;
  std::size_t usual_fields_ = 0;  // of the lines so far, 0: none yet
  std::size_t other_fields_ = 0;  // of the line before, if that was not the usual number
};

/// Whichever of the two the profile names.
class GyroScanner {
 public:
  explicit GyroScanner(const GyroProfile& profile);
  void push(std::span<const std::uint8_t> bytes, std::vector<GyroMessage>& out);
  const Counters& counters() const;

 private:
  GyroProtocol protocol_;
  WitmotionScanner witmotion_;
  TextGyroScanner text_;
};

}  // namespace thermorig::wire
