// SPDX-License-Identifier: MIT
#include "camera_line.h"

namespace thermorig::pipeline {

double frame_period_s(const CameraProfile& profile, const Fits& fits) {
  return fits.frame_period_s.value_or(1.0 / profile.output_rate_hz);
}

CameraLine::CameraLine(const CameraProfile& profile, const Fits& fits)
    : scanner_(profile.checksum),
      timing_(profile.link),
      exposure_(frame_period_s(profile, fits), fits.camera_mode),
      known_gaps_(fits.gaps),
      live_gaps_(frame_period_s(profile, fits)) {}

labels::FrameGap CameraLine::gap_before(const TimedFrame& frame) {
  const std::size_t index = frame_count_++;
  return index < known_gaps_.size() ? known_gaps_[index] : live_gaps_.push(frame, exposure_.mode());
}

std::span<const TimedFrame> CameraLine::push(std::span<const std::uint8_t> chunk, HostTime arrived,
                                             std::vector<TimedFrame>& out) {
  const std::size_t first = out.size();
  scanner_.push(chunk, messages_);
  timing_.chunk(scanner_.counters().bytes_received, arrived);
  for (const wire::CameraMessage& message : messages_) {
    TimedFrame& frame = out.emplace_back();
    frame.frame = message.frame;
    frame.span = message.span;
    frame.stamp = timing_.stamp(message.span);
    frame.resync_before = message.resync_before;
    exposure_.apply(frame);
    const labels::FrameGap gap = gap_before(frame);
    frame.missing_before = gap.missing;
    frame.late = gap.late;
  }
  messages_.clear();
  return std::span(out).subspan(first);
}

}  // namespace thermorig::pipeline
