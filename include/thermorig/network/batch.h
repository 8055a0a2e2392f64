// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>

namespace thermorig::network {

/// Up to 32 windows. All spans have the same length B.
struct Batch {
  std::span<const float* const> frames;  // B pointers, each to (Nf, H, W), oldest frame first, normalised
  std::span<const float> gyro;   // mean over the window's frames, normalised; empty for a thermal-only net
  std::span<const float> label;  // normalised; empty where only the forward pass is asked for
  std::span<const std::uint8_t> mirrored;  // 1: the images are to be flipped left to right; empty: none. Who
                                           // sets it negates gyro and label itself.
};

}  // namespace thermorig::network
