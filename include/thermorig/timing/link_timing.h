// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <deque>

#include "thermorig/core/chunk.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"

namespace thermorig::timing {

/// Time that `bytes` bytes take on the wire at 8N1; 0 where the link has no baud rate (USB-CDC).
double wire_time_s(std::uint64_t bytes, std::uint32_t baud);

/// The link budget of a device that sends `bytes_per_message` bytes `rate_hz` times a second.
struct LinkBudget {
  double load = 0.0;         // share of the link's capacity, 1.0 = full
  double max_rate_hz = 0.0;  // messages a second that fit
  bool fits() const { return load <= 1.0; }
};
LinkBudget link_budget(std::uint64_t bytes_per_message, double rate_hz, std::uint32_t baud);

/// Turns the arrival of chunks into the time of the messages in them: arrival of the chunk that brought the
/// message's last byte, minus the wire time from the message's first byte to the chunk's last, minus the
/// configured latency. This is the interface behind which better clocks will stand; it never uses a chunk
/// that has not arrived.
class LinkTiming {
 public:
  explicit LinkTiming(const PortProfile& link);

  /// A chunk arrived whose last byte is at stream offset `end` - 1. Chunks come in order.
  void chunk(std::uint64_t end, HostTime arrived);

  /// When the first byte of `span` began, minus the latency. All chunks up to span.end must have been
  /// announced (a bug otherwise). Spans must come in order of their ends; older chunks are forgotten.
  Stamp stamp(const StreamSpan& span);

 private:
  struct ChunkEnd {
    std::uint64_t end;
    HostTime arrived;
  };
  std::uint32_t baud_;
  double latency_s_;
  std::deque<ChunkEnd> chunks_;
};

}  // namespace thermorig::timing
