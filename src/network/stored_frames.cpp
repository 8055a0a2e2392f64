// SPDX-License-Identifier: MIT
#include "thermorig/network/stored_frames.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "thermorig/core/frame.h"
#include "thermorig/network/acquisition.h"

namespace thermorig::network {

namespace {

float temp_c_of(std::int16_t hundredths) {
  return static_cast<float>(hundredths) / 100.0F;
}

}  // namespace

PackedFrames::PackedFrames(std::vector<float> temp_c) {
  constexpr float most = std::numeric_limits<std::int16_t>::max() + 0.25F;  // scaling has rounded
  hundredths_.reserve(temp_c.size());
  for (const float one : temp_c) {
    const float scaled = one * 100.0F;
    if (!(std::abs(scaled) <= most)) break;
    const auto whole = static_cast<std::int16_t>(std::lrint(scaled));
    if (std::bit_cast<std::uint32_t>(temp_c_of(whole)) != std::bit_cast<std::uint32_t>(one)) break;
    hundredths_.push_back(whole);
  }
  if (hundredths_.size() == temp_c.size()) return;
  hundredths_ = {};
  temp_c_ = std::move(temp_c);
}

void PackedFrames::read(std::size_t first, std::span<float> temp_c) const {
  const std::size_t begin = first * frame_pixels;
  if (hundredths_.empty())
    std::ranges::copy(std::span(temp_c_).subspan(begin, temp_c.size()), temp_c.begin());
  else
    std::ranges::transform(std::span(hundredths_).subspan(begin, temp_c.size()), temp_c.begin(), temp_c_of);
}

void for_each_frame(const Acquisition& acquisition, const FrameLook& look) {
  std::vector<float> unpacked(acquisition.packed ? frame_pixels : 0);
  for (std::size_t frame = 0; frame < acquisition.frames(); ++frame) {
    if (acquisition.packed) acquisition.packed->read(frame, unpacked);
    look(frame, acquisition.packed
                    ? std::span<const float>(unpacked)
                    : std::span(acquisition.temp_c).subspan(frame * frame_pixels, frame_pixels));
  }
}

}  // namespace thermorig::network
