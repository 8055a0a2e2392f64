// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "thermorig/core/device.h"
#include "thermorig/core/raw_recording.h"
#include "thermorig/core/replay.h"

namespace thermorig::fit {

/// Where the stream of the device is broken: the offset of the first byte after each of its interruptions
/// that has bytes before and after it. Ascending, the first 255.
inline std::vector<std::uint64_t> break_offsets(const RawRecording& raw, Device device) {
  constexpr std::size_t most_breaks = 255;  // a file may claim any number, and each piece costs a walk
  const RawStream& stream = raw.received[device];
  std::vector<std::uint64_t> offsets;
  std::size_t chunk = 0;
  for (const Interruption& interruption : interruptions(raw)) {
    if (interruption.device != device) continue;
    while (chunk < stream.chunk_count() && stream.time(chunk) <= interruption.time) ++chunk;
    if (chunk == 0 || chunk == stream.chunk_count()) continue;
    const std::uint64_t offset = stream.chunk_end[chunk - 1];
    if (offsets.size() == most_breaks) break;
    if (offsets.empty() || offsets.back() < offset) offsets.push_back(offset);
  }
  return offsets;
}

/// Indices of the first message of each piece, 0 first; empty without messages. No message spans a break.
template <typename Messages>
std::vector<std::size_t> piece_begins(const Messages& messages, std::span<const std::uint64_t> breaks) {
  std::vector<std::size_t> begins;
  std::size_t next_break = 0;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    bool is_first = i == 0;
    for (; next_break < breaks.size() && breaks[next_break] <= messages[i].span.begin; ++next_break)
      is_first = true;
    if (is_first) begins.push_back(i);
  }
  return begins;
}

}  // namespace thermorig::fit
