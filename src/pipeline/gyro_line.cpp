// SPDX-License-Identifier: MIT
#include "gyro_line.h"

#include <cassert>

namespace thermorig::pipeline {

GyroLine::GyroLine(const GyroProfile& profile)
    : scanner_(profile),
      timing_(profile.link),
      axis_(static_cast<std::size_t>(profile.axis)),
      sign_(static_cast<float>(profile.sign)) {
  assert(profile.axis >= 0 && profile.axis < 3);
}

std::span<const TimedGyro> GyroLine::push(std::span<const std::uint8_t> chunk, HostTime arrived,
                                          std::vector<TimedGyro>& out) {
  const std::size_t first = out.size();
  scanner_.push(chunk, messages_);
  timing_.chunk(scanner_.counters().bytes_received, arrived);
  for (const wire::GyroMessage& message : messages_)
    out.push_back({.reading = message.reading,
                   .span = message.span,
                   .stamp = timing_.stamp(message.span),
                   .rate_dps = sign_ * message.reading.rate_dps[axis_],
                   .lost_before = message.lost_before});
  messages_.clear();
  return std::span(out).subspan(first);
}

}  // namespace thermorig::pipeline
