// SPDX-License-Identifier: MIT
#pragma once

#include <array>

#include "thermorig/core/surroundings/half_frame.h"
#include "thermorig/estimators/odometer/map.h"

namespace thermorig::odometer {

/// What is peculiar to each pixel: its constant error and its noise, by half-frame.
class PixelModel {
 public:
  /// A half without the pixels' errors; NaN where a pixel is stuck.
  HalfPixels corrected(const HalfFrame& half);

  /// What was left of each pixel, of those that were compared, and the variance that the map had in it.
  void learn(unsigned parity, const HalfPixels& residual, const HalfPixels& map_variance);

  void keep(Map& map) const;
  /// Of the same camera, or of one like it: what is learnt now soon outweighs it.
  void load(const Map& map);

  const HalfPixels& variance(unsigned parity) const { return variance_[parity]; }

  /// Hears the noise of all pixels in the same; few of a half may show what moves.
  void hear_noise(const HalfPixels& residual, const HalfPixels& map_variance);
  /// Of a reading, as it was heard: K^2.
  float noise_k2() const { return heard_variance_; }
  /// That of all pixels is known to be at least that, while nothing was learnt of single ones.
  void expect_noise(float variance_k2);

 private:
  float common_variance_ = 0.36F;  // of a reading: a data sheet's 0.6 K at first
  float heard_variance_ = 0.36F;   // the same, by hear_noise()
  std::array<HalfPixels, 2> offset_c_{}, variance_ = {uniform(0.36F), uniform(0.36F)}, squares_{}, count_{};
  std::array<HalfPixels, 2> last_c_{}, repeats_{};

  static HalfPixels uniform(float value) {
    HalfPixels pixels;
    pixels.fill(value);
    return pixels;
  }
};

}  // namespace thermorig::odometer
