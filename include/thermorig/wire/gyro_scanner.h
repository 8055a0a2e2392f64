// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "thermorig/core/chunk.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/reading.h"
#include "thermorig/wire/counters.h"

namespace thermorig::wire {

struct GyroMessage {
  GyroReading reading;
  StreamSpan span;
  bool lost_before = false;  // bytes were skipped or damaged since the message before
};

/// Finds WitMotion packets (11 bytes, 0x55 type data sum) in a stream of bytes; packets of type 0x52 become
/// readings, others are counted as replies. Source: protocols/witmotion.md.
class WitmotionScanner {
 public:
  void push(std::span<const std::uint8_t> bytes, std::vector<GyroMessage>& out);
  const Counters& counters() const { return counters_; }

 private:
  Counters counters_;
  std::vector<std::uint8_t> pending_;
  std::uint64_t pending_begin_ = 0;
  bool resync_ = false;
  bool locked_ = false;  // two good packets in a row have been seen
};

/// Reads gyros that print one line of text a sample. Source: protocols/text_gyro.md.
class TextGyroScanner {
 public:
  explicit TextGyroScanner(TextColumns columns);
  void push(std::span<const std::uint8_t> bytes, std::vector<GyroMessage>& out);
  const Counters& counters() const { return counters_; }

 private:
  TextColumns columns_;
  Counters counters_;
  std::string line_;
  std::uint64_t line_begin_ = 0;
  bool resync_ = false;
  bool overlong_ = false;
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
