// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "thermorig/network/acquisition.h"

namespace thermorig::network {

/// Takes frames out of their runs (run 0) that must not reach a network: a label or a gyro mean that is not a
/// number or beyond 10,000 deg/s, a pixel that is not a number or outside -60..400 degC. The labeller calls
/// no such frame valid, but a file may say anything. Thermal-only and fusion networks thus see the same
/// windows, those for which both sensors have something to say.
void clear_unsound_frames(Acquisition& acquisition);

/// Whether all pixels of a frame are numbers within -60..400 degC.
bool is_sound_image(std::span<const float> temp_c);

}  // namespace thermorig::network
