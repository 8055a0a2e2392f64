// SPDX-License-Identifier: MIT
#include "camera_decoder.h"

#include <utility>

namespace thermorig::pipeline {

namespace {
constexpr std::size_t frames_for_mode = 16;  // by then the half-frames show how the camera works

double frame_period_s(const CameraProfile& profile, const Fits& fits) {
  return fits.frame_period_s.value_or(1.0 / profile.output_rate_hz);
}
}  // namespace

labels::ExposureRule exposure_rule(const CameraProfile& profile, const Fits& fits) {
  return labels::ExposureRule(frame_period_s(profile, fits), fits.camera_mode, fits.newer_half);
}

CameraDecoder::CameraDecoder(const CameraProfile& profile, const Fits& fits)
    : profile_(profile),
      period_s_(frame_period_s(profile, fits)),
      scanner_(sensors::camera_scanner(profile)),
      timing_(profile.link, causal_rate_hz(fits.times[Device::camera], profile.output_rate_hz)),
      final_times_(fits.times[Device::camera]),
      exposure_(exposure_rule(profile, fits)),
      known_gaps_(fits.gaps),
      live_gaps_(period_s_),
      newer_half_(fits.newer_half) {}

labels::FrameGap CameraDecoder::gap_before(const TimedFrame& frame, labels::HalvesWitness halves) {
  const std::size_t index = frame_count_++;
  ++frames_since_;
  const bool was_away = std::exchange(was_away_, false);
  if (index < known_gaps_.size()) return known_gaps_[index];
  const labels::FrameGap gap = live_gaps_.push(frame, halves);
  return was_away ? gap_of_absence(frame) : gap;
}

labels::FrameGap CameraDecoder::gap_of_absence(const TimedFrame& frame) {
  if (!last_frame_) return {};
  return {.missing = labels::missing_in_absence(*last_frame_, frame.stamp.time, period_s_), .late = false};
}

std::span<const TimedFrame> CameraDecoder::interrupt(std::vector<TimedFrame>& out) {
  const std::size_t first = out.size();
  finish(out);
  scanner_.restart();
  timing_.restart();
  live_gaps_ = labels::LiveFrameGaps(period_s_);
  std::optional<labels::CameraMode> mode;
  if (frames_since_ >= frames_for_mode) mode = exposure_.mode();
  exposure_ = labels::ExposureRule(period_s_, mode, newer_half_);
  was_away_ = was_away_ || last_frame_.has_value();
  frames_since_ = 0;
  return std::span(out).subspan(first);
}

std::span<const TimedFrame> CameraDecoder::push(std::span<const std::uint8_t> chunk, HostTime arrived,
                                                std::vector<TimedFrame>& out) {
  scanner_.push(chunk, messages_);
  timing_.chunk(scanner_.counters().bytes_received, arrived);
  return take(out);
}

std::span<const TimedFrame> CameraDecoder::finish(std::vector<TimedFrame>& out) {
  scanner_.finish(messages_);
  return take(out);
}

std::span<const TimedFrame> CameraDecoder::take(std::vector<TimedFrame>& out) {
  const std::size_t first = out.size();
  for (const wire::CameraMessage& message : messages_) {
    TimedFrame& frame = out.emplace_back();
    frame.frame = message.frame;
    frame.span = message.span;
    frame.fresh_even = message.fresh.even;
    frame.fresh_odd = message.fresh.odd;
    frame.resync_before = message.resync_before;
    const labels::HalvesWitness halves = exposure_.look(frame);
    const bool lost_before = labels::may_be_missing(halves) || message.resync_before;
    frame.stamp = timing_.stamp(message.span, {.lost_before = lost_before, .device_s = {}});
    const bool is_known = final_times_.put_next(frame.stamp);
    exposure_.expose(frame);
    const labels::FrameGap gap = gap_before(frame, halves);
    frame.missing_before = gap.missing;
    frame.late = gap.late && !is_known;  // its turn fixes when a frame was taken, however late it was read
    last_frame_ = frame.stamp.time;
  }
  messages_.clear();
  return std::span(out).subspan(first);
}

}  // namespace thermorig::pipeline
