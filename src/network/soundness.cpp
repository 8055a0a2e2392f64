// SPDX-License-Identifier: MIT
#include "thermorig/network/soundness.h"

#include <algorithm>

#include "thermorig/core/frame.h"
#include "thermorig/core/reading.h"

namespace thermorig::network {

namespace {

bool is_sound(const Acquisition& acquisition, std::size_t frame, std::span<const float> temp_c) {
  return is_rate(acquisition.label_dps[frame]) && is_rate(acquisition.gyro_dps[frame]) &&
         is_sound_image(temp_c);
}

}  // namespace

bool is_sound_image(std::span<const float> temp_c) {
  return std::all_of(temp_c.begin(), temp_c.end(), is_temperature);
}

void clear_unsound_frames(Acquisition& acquisition) {
  for_each_frame(acquisition, [&](std::size_t frame, std::span<const float> temp_c) {
    if (acquisition.run[frame] != 0 && !is_sound(acquisition, frame, temp_c)) acquisition.run[frame] = 0;
  });
}

}  // namespace thermorig::network
