// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
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

struct RawLine;

/// Where a stream was joined. In the middle of a line, its tail may read as a whole line with a false number.
enum class StreamStart : std::uint8_t { anywhere, at_line_start };

/// Reads gyros that print one line of text a sample. Source: protocols/text_gyro.md.
///
/// Text has no checksum. What can be told from it is: without a prefix, the first line of a stream that was
/// joined anywhere may be the tail of one and is not read; a line with another number of fields than the
/// lines before is damaged. How many fields are usual, two samples in a row tell, so the first one waits for
/// the second.
class TextGyroScanner {
 public:
  explicit TextGyroScanner(TextColumns columns, StreamStart start = StreamStart::anywhere);
  void push(std::span<const std::uint8_t> bytes, std::vector<GyroMessage>& out);
  /// The stream ends here: what only waits for the bytes behind it is decided. A line without an end stays
  /// pending, since it may be cut inside a number. The last call.
  void finish(std::vector<GyroMessage>& out);
  const Counters& counters() const { return ledger_.counters; }

 private:
  using Bytes = std::span<const std::uint8_t>;

  std::size_t step(Bytes rest, std::vector<GyroMessage>& out);
  std::size_t skip_to_line_end(Bytes rest);
  std::size_t take_line(const RawLine& line, Bytes rest, std::vector<GyroMessage>& out);
  std::size_t pass_over(std::size_t bytes);
  std::size_t learn_fields(Bytes rest) const;
  bool has_usual_fields(std::size_t fields);

  TextColumns columns_;
  ByteLedger ledger_;
  std::vector<std::uint8_t> pending_;  // received, not yet booked
  bool at_line_start_;
  std::size_t usual_fields_ = 0;  // of the lines so far, 0: none yet
  std::size_t other_fields_ = 0;  // of the line before, if that was not the usual number
  bool ended_ = false;
};

/// Whichever of the two the profile names.
class GyroScanner {
 public:
  explicit GyroScanner(const GyroProfile& profile, StreamStart start = StreamStart::anywhere);
  void push(std::span<const std::uint8_t> bytes, std::vector<GyroMessage>& out);
  void finish(std::vector<GyroMessage>& out);
  const Counters& counters() const;

 private:
  GyroProtocol protocol_;
  WitmotionScanner witmotion_;
  TextGyroScanner text_;
};

}  // namespace thermorig::wire
