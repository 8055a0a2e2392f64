// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "thermorig/core/time.h"
#include "thermorig/simulation/virtual_rig.h"
#include "timing_baselines.h"

namespace thermorig::bench {

/// The message that the device sent, of each message that the program decoded; null where the bytes are no
/// message's. It may be a part of what was sent: a banner ahead of it belongs to none.
template <typename Timed>
std::vector<const simulation::SentMessage*> sent_of(const std::vector<Timed>& decoded,
                                                    const std::vector<simulation::SentMessage>& sent) {
  std::vector<const simulation::SentMessage*> found;
  found.reserve(decoded.size());
  std::size_t next = 0;
  for (const Timed& message : decoded) {
    while (next < sent.size() && sent[next].span.end < message.span.end) ++next;
    const bool same = next < sent.size() && sent[next].span.begin <= message.span.begin;
    found.push_back(same ? &sent[next] : nullptr);
  }
  return found;
}

/// What a stamp stands for: the end of a frame's exposure, the middle of a gyro sample's interval.
inline HostTime instant_of(const simulation::SentMessage& frame, Device device) {
  if (device == Device::camera) return frame.exposure_end;
  return frame.exposure_begin + (frame.exposure_end - frame.exposure_begin) / 2;
}

}  // namespace thermorig::bench
