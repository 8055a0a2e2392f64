// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "thermorig/core/frame.h"
#include "thermorig/core/sample.h"

namespace thermorig {

/// Pixels by their place in a frame (row * frame_columns + column), ascending.
using PixelPlaces = std::vector<std::uint16_t>;

/// Finds a camera's dead, stuck and hot pixels (the MLX90640's data sheet allows four) while its frames come:
/// pixels whose readings hardly change though those around them do, that stay degrees away from those around
/// them, or that give no number. All around: of the same chess half, which is exposed at the same time. While
/// the rig stands still a small hot thing looks like a hot pixel, until the rig turns. No allocation in
/// add().
class PixelWatch {
 public:
  PixelWatch();

  /// Frames that are stale, or stand in for one, say nothing.
  void add(const TimedFrame& frame);

  /// None before both halves were read some twenty times, and where so many seem to be bad that it is the
  /// scene, or the whole camera.
  const PixelPlaces& bad() const { return bad_; }

 private:
  void add_half(const ThermalFrame& frame, unsigned parity);
  void judge();
  bool is_stuck(std::size_t place) const;

  struct Pixel {
    float last_c = 0.0F;
    float off_c = 0.0F;     // mean of what it shows beside those around it
    float change_c = 0.0F;  // mean size of the step from one reading to the next
    float unread = 0.0F;    // share of readings that are no number
  };
  std::array<Pixel, frame_pixels> pixels_{};
  std::array<std::uint32_t, 2> readings_{};  // of each half
  PixelPlaces bad_;
};

/// Gives each bad pixel the mean of the good ones around it, in whole hundredths of a degree.
void mend(ThermalFrame& frame, std::span<const std::uint16_t> bad);

/// "3,17 12,5": row and column of each.
std::string text_of(const PixelPlaces& places);

/// The places in such a text; what is none is left out.
PixelPlaces pixel_places(std::string_view text);

}  // namespace thermorig
