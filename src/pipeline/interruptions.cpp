// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/interruptions.h"

#include <algorithm>

namespace thermorig::pipeline {

namespace {
constexpr std::size_t most_breaks =
    255;  // a file may claim any number, and each piece costs a walk over its chunks
}  // namespace

bool is_interruption(const RecordingEvent& event) {
  return event.source && (event.kind == EventKind::device_lost || event.kind == EventKind::missing);
}

std::vector<Interruption> interruptions(const RawRecording& raw) {
  std::vector<Interruption> found;
  for (const RecordingEvent& event : raw.events)
    if (is_interruption(event)) found.push_back({*event.source, event.time});
  std::stable_sort(found.begin(), found.end(),
                   [](const Interruption& a, const Interruption& b) { return a.time < b.time; });
  return found;
}

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

}  // namespace thermorig::pipeline
