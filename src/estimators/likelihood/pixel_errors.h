// SPDX-License-Identifier: MIT
#pragma once

#include <array>

#include "thermorig/core/frame.h"
#include "window_lines.h"

namespace thermorig::likelihood {

/// Errors that pixels always have, and pixels that are broken. They stand still while the scene turns: left
/// in, every window says a little that nothing moves.
class PixelErrors {
 public:
  /// The fresh half of a frame without them; a broken pixel shows what those about it do. False: too many
  /// pixels are no readings.
  bool clean(const ThermalFrame& frame, unsigned parity, HalfLines& lines);

  /// The half that was cleaned last was seen in motion: what its pixels show beyond those about them is, on
  /// average, their own.
  void learn(unsigned parity);

 private:
  struct Pixel {
    float last_c = 0.0F, repeats = 0.0F;  // how often it has shown the same
    float beyond_c = 0.0F;                // those about it, in the newest half
    float error_c = 0.0F;                 // mean of that
  };
  struct Half {
    std::array<Pixel, frame_pixels / 2> pixels{};
    float count = 0.0F;  // halves that were learnt from
  };
  std::array<Half, 2> halves_;
  std::array<float, frame_pixels / 2> about_c_{}, sizes_{};
};

}  // namespace thermorig::likelihood
