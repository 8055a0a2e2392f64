// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "thermorig/core/raw_recording.h"
#include "thermorig/core/time.h"

namespace thermorig::pipeline {

/// The earliest proof of each message's begin: it had begun to be sent by then, since later bytes had
/// arrived (arrival minus the wire time of the bytes in between). `spans` in the order of the stream, all
/// within `received`.
std::vector<HostTime> begin_proofs(const RawStream& received, std::span<const StreamSpan> spans,
                                   std::uint32_t baud);

/// True if the bytes and arrivals that the messages came from are there.
bool holds(const RawStream& received, std::span<const StreamSpan> spans);

/// Where the messages stand in their stream.
template <typename Messages>
std::vector<StreamSpan> spans_of(const Messages& messages) {
  std::vector<StreamSpan> spans;
  spans.reserve(messages.size());
  for (const auto& message : messages) spans.push_back(message.span);
  return spans;
}

}  // namespace thermorig::pipeline
