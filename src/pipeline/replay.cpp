// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/replay.h"

#include <utility>

namespace thermorig::pipeline {

std::vector<Measurement> feed(Pipeline& pipeline, const ReplayStep& step) {
  if (step.is_interruption) return pipeline.interrupt(*step.from, step.time);
  if (step.from) return pipeline.feed(*step.from, step.bytes, step.time);
  pipeline.sent(*step.to, step.bytes, step.time);
  return {};
}

namespace {

std::optional<HostTime> camera_gone(const RawRecording& raw) {
  for (const RecordingEvent& event : raw.events)
    if (event.kind == EventKind::missing && event.source == Device::camera) return event.time;
  return std::nullopt;
}

}  // namespace

CausalReplay::CausalReplay(const RawRecording& raw)
    : end_time_(raw.end_time), replay_(raw), pipeline_(raw.header.profile), camera_gone_(camera_gone(raw)) {}

std::optional<ReplayMoment> CausalReplay::next() {
  if (const auto step = replay_.next()) {
    if (camera_gone_ && step->time > *camera_gone_)
      pipeline_.stand_in_for_camera(*std::exchange(camera_gone_, std::nullopt));
    std::vector<Measurement> measurements = feed(pipeline_, *step);
    return ReplayMoment{step->time, step->from, pipeline_.take_streams(), std::move(measurements)};
  }
  if (std::exchange(ended_, true)) return std::nullopt;
  std::vector<Measurement> measurements = pipeline_.finish();
  return ReplayMoment{end_time_, std::nullopt, pipeline_.take_streams(), std::move(measurements)};
}

}  // namespace thermorig::pipeline
