// SPDX-License-Identifier: MIT
#include "camera_line.h"

namespace thermorig::pipeline {

namespace {
double frame_period_s(const CameraProfile& profile, const Fits& fits) {
  return fits.frame_period_s.value_or(1.0 / profile.output_rate_hz);
}
}  // namespace

labels::ExposureRule exposure_rule(const CameraProfile& profile, const Fits& fits) {
  return labels::ExposureRule(frame_period_s(profile, fits), fits.camera_mode, fits.newer_half);
}

CameraLine::CameraLine(const CameraProfile& profile, const Fits& fits)
    : scanner_(profile.checksum),
      timing_(profile.link, profile.output_rate_hz),
      final_times_(fits.times[Device::camera]),
      exposure_(exposure_rule(profile, fits)),
      known_gaps_(fits.gaps),
      live_gaps_(frame_period_s(profile, fits)) {}

labels::FrameGap CameraLine::gap_before(const TimedFrame& frame) {
  const std::size_t index = frame_count_++;
  return index < known_gaps_.size() ? known_gaps_[index] : live_gaps_.push(frame, exposure_.mode());
}

std::span<const TimedFrame> CameraLine::push(std::span<const std::uint8_t> chunk, HostTime arrived,
                                             std::vector<TimedFrame>& out) {
  scanner_.push(chunk, messages_);
  timing_.chunk(scanner_.counters().bytes_received, arrived);
  return take(out);
}

std::span<const TimedFrame> CameraLine::finish(std::vector<TimedFrame>& out) {
  scanner_.finish(messages_);
  return take(out);
}

std::span<const TimedFrame> CameraLine::take(std::vector<TimedFrame>& out) {
  const std::size_t first = out.size();
  for (const wire::CameraMessage& message : messages_) {
    TimedFrame& frame = out.emplace_back();
    frame.frame = message.frame;
    frame.span = message.span;
    frame.resync_before = message.resync_before;
    const bool lost_before = exposure_.look(frame) || message.resync_before;
    frame.stamp = timing_.stamp(message.span, {.lost_before = lost_before, .device_s = {}});
    const bool is_known = final_times_.put_next(frame.stamp);
    exposure_.expose(frame);
    const labels::FrameGap gap = gap_before(frame);
    frame.missing_before = gap.missing;
    frame.late = gap.late && !is_known;  // its turn tells when a frame was taken, however late it was read
  }
  messages_.clear();
  return std::span(out).subspan(first);
}

}  // namespace thermorig::pipeline
