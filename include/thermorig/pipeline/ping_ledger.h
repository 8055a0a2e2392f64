// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>

#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"
#include "thermorig/pipeline/timing/ping_clock.h"

namespace thermorig::pipeline {

/// Remembers the pings that were written to the servo until their answers come, and makes one exchange of
/// both: bounds of the servo's clock from both sides, the wire times taken off.
class PingLedger {
 public:
  /// More pings without an answer than any stalled host leaves behind.
  static constexpr std::size_t remembered = 256;

  explicit PingLedger(std::uint32_t baud) : baud_(baud) {}

  /// One write: whole frames, as the recorder writes them.
  void sent(std::span<const std::uint8_t> bytes, HostTime before_write);

  /// `telemetry`: a message of the same epoch, near the answer in the stream: it unwraps the answer's times.
  /// `not_after`: the answer had begun to be sent by then. None if the ping is not known. Where a token was
  /// used again (the recorder counts anew after a reset), the newest ping before the answer is meant.
  std::optional<timing::PingBound> exchange(const TimedPong& pong, const TimedServo& telemetry,
                                            HostTime not_after) const;

 private:
  struct Ping {
    std::uint32_t token = 0;
    HostTime written{};
    HostTime received_not_before{};  // time of the write and the wire time of its bytes
  };
  std::uint32_t baud_;
  std::deque<Ping> pings_;
};

}  // namespace thermorig::pipeline
