// SPDX-License-Identifier: MIT
#include "thermorig/network/stored_frames.h"

#include <algorithm>
#include <vector>

#include "thermorig/core/frame.h"
#include "thermorig/network/acquisition.h"

namespace thermorig::network {

namespace {

constexpr std::size_t frames_at_once = 256;

void for_each_stored_frame(const Acquisition& acquisition, const FrameLook& look) {
  std::vector<float> temp_c(std::min(frames_at_once, acquisition.frames()) * frame_pixels);
  for (std::size_t first = 0; first < acquisition.frames(); first += frames_at_once) {
    const std::size_t frames = std::min(frames_at_once, acquisition.frames() - first);
    const auto read = std::span(temp_c).first(frames * frame_pixels);
    acquisition.stored->read(first, read);
    for (std::size_t i = 0; i < frames; ++i) look(first + i, read.subspan(i * frame_pixels, frame_pixels));
  }
}

}  // namespace

void for_each_frame(const Acquisition& acquisition, const FrameLook& look) {
  if (acquisition.stored) return for_each_stored_frame(acquisition, look);
  const std::span<const float> temp_c(acquisition.temp_c);
  for (std::size_t frame = 0; frame < acquisition.frames(); ++frame)
    look(frame, temp_c.subspan(frame * frame_pixels, frame_pixels));
}

}  // namespace thermorig::network
