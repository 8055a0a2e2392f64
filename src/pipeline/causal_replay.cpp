// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/causal_replay.h"

#include <utility>

namespace thermorig::pipeline {

CausalReplay::CausalReplay(const RawRecording& raw)
    : end_time_(raw.end_time), replay_(raw), pipeline_(raw.header.profile) {}

std::optional<ReplayMoment> CausalReplay::next() {
  if (const auto step = replay_.next()) return moment(step->time, step->from, feed(pipeline_, *step));
  if (std::exchange(ended_, true)) return std::nullopt;
  return moment(end_time_, std::nullopt, pipeline_.finish());
}

ReplayMoment CausalReplay::moment(HostTime time, std::optional<Device> from,
                                  const std::vector<LabelledSample>& samples) {
  ReplayMoment moment{time, from, pipeline_.take_streams(), {}};
  pairs_.add(std::exchange(moment.streams.frames, {}));
  pairs_.add(samples);
  moment.pairs = pairs_.take();
  return moment;
}

}  // namespace thermorig::pipeline
