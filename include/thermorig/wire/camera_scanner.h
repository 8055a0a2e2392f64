// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "thermorig/core/chunk.h"
#include "thermorig/core/frame.h"
#include "thermorig/core/profile.h"
#include "thermorig/wire/counters.h"

namespace thermorig::wire {

struct CameraMessage {
  ThermalFrame frame;
  StreamSpan span;
  bool resync_before = false;  // bytes were skipped or damaged since the message before
};

/// Finds GY-MCU90640 frames in a stream of bytes: 1544 bytes, header, length, 768 signed centidegrees, Ta,
/// 16-bit word sum. Any chunking gives the same frames. Source: protocols/gy_mcu90640.md.
class CameraScanner {
 public:
  explicit CameraScanner(ChecksumPolicy checksum = ChecksumPolicy::word);

  /// Takes the next bytes of the stream and appends the frames that they complete to `out`.
  void push(std::span<const std::uint8_t> bytes, std::vector<CameraMessage>& out);

  const Counters& counters() const { return counters_; }

 private:
  ChecksumPolicy checksum_;
  Counters counters_;
  std::vector<std::uint8_t> pending_;
  std::uint64_t pending_begin_ = 0;  // stream offset of pending_[0]
  bool resync_ = false;
};

}  // namespace thermorig::wire
