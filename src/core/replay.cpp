// SPDX-License-Identifier: MIT
#include "thermorig/core/replay.h"

#include <algorithm>

namespace thermorig {

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

namespace {

/// Whose next chunk is the first of all.
std::optional<Device> earliest(const PerDevice<RawStream>& streams, const PerDevice<std::size_t>& next) {
  std::optional<Device> earliest;
  for (const Device device : all_devices) {
    if (next[device] == streams[device].chunk_count()) continue;
    if (!earliest || streams[device].time(next[device]) < streams[*earliest].time(next[*earliest]))
      earliest = device;
  }
  return earliest;
}

}  // namespace

std::optional<ReplayStep> Replay::next() {
  const std::optional<Device> from = earliest(raw_.received, next_received_);
  const auto arrival = [&] { return raw_.received[*from].time(next_received_[*from]); };
  if (next_interruption_ < interruptions_.size()) {
    const Interruption& gone = interruptions_[next_interruption_];
    if (!from || gone.time < arrival()) {
      ++next_interruption_;
      return ReplayStep{
          .from = gone.device, .to = {}, .bytes = {}, .time = gone.time, .is_interruption = true};
    }
  }
  if (!from) return std::nullopt;
  const std::optional<Device> to = earliest(raw_.sent, next_sent_);
  if (to && raw_.sent[*to].time(next_sent_[*to]) <= arrival()) {
    const std::size_t sent = next_sent_[*to]++;
    return ReplayStep{
        .from = {}, .to = to, .bytes = raw_.sent[*to].chunk(sent), .time = raw_.sent[*to].time(sent)};
  }
  const std::size_t index = next_received_[*from]++;
  const RawStream& stream = raw_.received[*from];
  return ReplayStep{.from = from, .to = {}, .bytes = stream.chunk(index), .time = stream.time(index)};
}

}  // namespace thermorig
