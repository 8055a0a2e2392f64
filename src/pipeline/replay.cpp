// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/replay.h"

namespace thermorig::pipeline {

std::optional<Device> Replay::earliest() const {
  std::optional<Device> earliest;
  for (const Device device : all_devices) {
    const RawStream& stream = raw_.received[device];
    if (next_received_[device] == stream.chunk_count()) continue;
    if (!earliest ||
        stream.time(next_received_[device]) < raw_.received[*earliest].time(next_received_[*earliest]))
      earliest = device;
  }
  return earliest;
}

std::optional<ReplayStep> Replay::next() {
  const std::optional<Device> device = earliest();
  if (next_interruption_ < interruptions_.size()) {
    const Interruption& gone = interruptions_[next_interruption_];
    if (!device || gone.time < raw_.received[*device].time(next_received_[*device])) {
      ++next_interruption_;
      return ReplayStep{.from = gone.device, .bytes = {}, .time = gone.time, .is_interruption = true};
    }
  }
  if (!device) return std::nullopt;
  const RawStream& stream = raw_.received[*device];
  const std::size_t index = next_received_[*device];
  if (next_sent_ < raw_.sent.chunk_count() && raw_.sent.time(next_sent_) <= stream.time(index)) {
    const std::size_t sent = next_sent_++;
    return ReplayStep{.from = std::nullopt, .bytes = raw_.sent.chunk(sent), .time = raw_.sent.time(sent)};
  }
  ++next_received_[*device];
  return ReplayStep{.from = device, .bytes = stream.chunk(index), .time = stream.time(index)};
}

std::vector<Measurement> feed(Pipeline& pipeline, const ReplayStep& step) {
  if (step.is_interruption) return pipeline.interrupt(*step.from, step.time);
  if (step.from) return pipeline.feed(*step.from, step.bytes, step.time);
  pipeline.sent(step.bytes, step.time);
  return {};
}

}  // namespace thermorig::pipeline
