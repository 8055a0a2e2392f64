// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "thermorig/core/device.h"
#include "thermorig/core/raw_recording.h"
#include "thermorig/pipeline/pipeline.h"

namespace thermorig::pipeline {

/// Bytes that came in one read(), or that went to the servo in one write().
struct ReplayStep {
  std::optional<Device> from;  // none: they went to the servo
  std::span<const std::uint8_t> bytes;
  HostTime time{};  // of arrival; before write()
};

/// Walks everything that a recording holds in the order in which it came: the one place that knows it.
/// Chunks of equal times go in the order of the devices, and what was sent comes before what arrived.
class Replay {
 public:
  /// `raw` must outlive it.
  explicit Replay(const RawRecording& raw) : raw_(raw) {}

  /// Nothing after the last chunk that arrived: what was sent after it was never answered.
  std::optional<ReplayStep> next();

 private:
  std::optional<Device> earliest() const;

  const RawRecording& raw_;
  PerDevice<std::size_t> next_received_{};
  std::size_t next_sent_ = 0;
};

/// The step into the pipeline, and the samples that it completed.
std::vector<LabelledSample> feed(Pipeline& pipeline, const ReplayStep& step);

}  // namespace thermorig::pipeline
