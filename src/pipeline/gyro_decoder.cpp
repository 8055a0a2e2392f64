// SPDX-License-Identifier: MIT
#include "gyro_decoder.h"

#include <cassert>
#include <utility>

namespace thermorig::pipeline {

namespace {
timing::StampHint hint(const wire::GyroMessage& message) {
  timing::StampHint hint{.lost_before = message.lost_before, .device_s = {}};
  const auto& device_time_us = message.reading.device_time_us;
  if (device_time_us) hint.device_s = 1e-6 * static_cast<double>(*device_time_us);
  return hint;
}
}  // namespace

GyroDecoder::GyroDecoder(const GyroProfile& profile, const Fits& fits)
    : scanner_(sensors::gyro_scanner(profile)),
      timing_(profile.link, profile.output_rate_hz),
      final_times_(fits.times[Device::gyro]),
      axis_(static_cast<std::size_t>(profile.axis)),
      sign_(static_cast<float>(profile.sign)) {
  assert(profile.axis >= 0 && profile.axis < 3);
}

std::span<const TimedGyro> GyroDecoder::push(std::span<const std::uint8_t> chunk, HostTime arrived,
                                             std::vector<TimedGyro>& out) {
  scanner_.push(chunk, messages_);
  timing_.chunk(scanner_.counters().bytes_received, arrived);
  return take(out);
}

std::span<const TimedGyro> GyroDecoder::finish(std::vector<TimedGyro>& out) {
  scanner_.finish(messages_);
  return take(out);
}

std::span<const TimedGyro> GyroDecoder::interrupt(std::vector<TimedGyro>& out) {
  const std::size_t first = out.size();
  finish(out);
  scanner_.restart();
  timing_.restart();
  losses_.interrupt();
  was_away_ = scanner_.counters().messages > 0;
  return std::span(out).subspan(first);
}

std::span<const TimedGyro> GyroDecoder::take(std::vector<TimedGyro>& out) {
  const std::size_t first = out.size();
  for (const wire::GyroMessage& message : messages_) {
    out.push_back({.reading = message.reading,
                   .span = message.span,
                   .stamp = timing_.stamp(message.span, hint(message)),
                   .rate_dps = sign_ * message.reading.rate_dps[axis_],
                   .lost_before = std::exchange(was_away_, false) || message.lost_before});
    if (!final_times_.put_next(out.back().stamp)) losses_.sample(out.back(), timing_.missing());
  }
  messages_.clear();
  counters_ = scanner_.counters();
  counters_.lost += losses_.count();
  return std::span(out).subspan(first);
}

}  // namespace thermorig::pipeline
