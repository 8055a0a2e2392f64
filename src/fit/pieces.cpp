// SPDX-License-Identifier: MIT
#include "pieces.h"

#include "thermorig/core/replay.h"

namespace thermorig::fit {

namespace {
// A file may claim any number, and each piece costs a walk over its chunks.
constexpr std::size_t most_breaks = 255;
}  // namespace

std::vector<std::uint64_t> break_offsets(const RawRecording& raw, Device device) {
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

}  // namespace thermorig::fit
