// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "optics.h"
#include "random.h"
#include "thermorig/core/frame.h"
#include "thermorig/simulation/world.h"

namespace thermorig::simulation {

/// Noise of the MLX90640 by lens and refresh rate: data sheet rev 11, figures 19 to 23.
struct NoiseLevel {
  double median_k = 0.66;  // of the median pixel
  double corner_over_centre = 1.35;

  /// `refresh_rate_hz`: chess halves a second. Noise grows with its square root.
  static NoiseLevel of(double field_of_view_deg, double refresh_rate_hz);
};

/// What a real sensor adds to what its pixels see: white noise, fixed pattern, a constant difference between
/// the chess halves, noise common to a half, dead pixels, a warming housing, rare glitches.
class PixelNoise {
 public:
  PixelNoise(const NoiseLevel& level, bool warm, std::uint64_t seed, const CameraWorld& world = {});

  /// Turns the seen temperatures of chess half `parity` into readings, written to the half's pixels of
  /// `frame`.
  void read_half(const PixelColumns& seen_c, unsigned parity, double time_s, ThermalFrame& frame);

  /// From the next half on: another refresh rate.
  void grow(double factor);

  /// The sensor's own temperature.
  float sensor_temp_c(double time_s);

 private:
  struct DeadPixel {
    std::size_t index;
    float reading_c;
  };
  void add_fixed_pattern();
  void kill_pixels(int count, Random& random);

  Random fixed_;   // drawn once, at power-up
  Random random_;  // drawn for every half
  bool warm_;
  double warm_up_k_;        // offset right after power-up
  double world_warm_up_k_;  // beside that, and whether warm or not
  double sensor_temp_c_;    // when warm
  double sensor_wander_k_ = 0.0;
  PixelColumns sigma_k_{};
  PixelColumns offset_k_{};
  std::vector<DeadPixel> dead_;
};

}  // namespace thermorig::simulation
