// SPDX-License-Identifier: MIT
#include <cmath>

#include "scene_shapes.h"

namespace thermorig::simulation {
namespace {

/// Random values on a square lattice that closes around the panorama.
class Lattice {
 public:
  Lattice(Random& random, int cells_around) : cells_around_(cells_around) {
    const int rows = cells_around / 4 + 2;  // 90 of 360 degrees
    values_.resize(static_cast<std::size_t>(rows) * static_cast<std::size_t>(cells_around));
    for (auto& value : values_) value = static_cast<float>(random.normal());
  }

  /// Adds `amplitude` times the smoothly interpolated lattice.
  void add_to(std::vector<float>& texture, float amplitude) const {
    for (int row = 0; row < Panorama::elevations; ++row)
      add_row(&texture[static_cast<std::size_t>(row) * Panorama::azimuths], row, amplitude);
  }

 private:
  static float smooth(float x) { return x * x * (3.0F - 2.0F * x); }

  float value(int row, int column) const {
    return values_[static_cast<std::size_t>(row * cells_around_ + column % cells_around_)];
  }

  void add_row(float* out, int row, float amplitude) const {
    const float scale = static_cast<float>(cells_around_) / 360.0F;
    const float y = static_cast<float>(row * Panorama::elevation_step_deg) * scale;
    const int below = static_cast<int>(y);
    const float up = smooth(y - static_cast<float>(below));
    for (int azimuth = 0; azimuth < Panorama::azimuths; ++azimuth) {
      const float x = static_cast<float>(azimuth * Panorama::azimuth_step_deg) * scale;
      const int left = static_cast<int>(x);
      const float right = smooth(x - static_cast<float>(left));
      const float low = std::lerp(value(below, left), value(below, left + 1), right);
      const float high = std::lerp(value(below + 1, left), value(below + 1, left + 1), right);
      out[azimuth] += amplitude * std::lerp(low, high, up);
    }
  }

  int cells_around_;
  std::vector<float> values_;
};

void standardise(std::vector<float>& texture) {
  double sum = 0.0;
  double squares = 0.0;
  for (const float value : texture) {
    sum += value;
    squares += static_cast<double>(value) * value;
  }
  const double count = static_cast<double>(texture.size());
  const double mean = sum / count;
  const double deviation = std::sqrt(squares / count - mean * mean);
  for (float& value : texture) value = static_cast<float>((value - mean) / deviation);
}

}  // namespace

std::vector<float> fractal_texture(Random& random) {
  std::vector<float> texture(std::size_t{Panorama::azimuths} * Panorama::elevations);
  // Amplitudes ~ f^-1.2 in two dimensions leave each octave a variance ~ f^-0.4.
  for (int octave = 0; octave < 7; ++octave) {
    const int cells_around = 8 << octave;  // cells of 45 down to 0.7 degrees
    Lattice(random, cells_around).add_to(texture, static_cast<float>(std::exp2(-0.2 * octave)));
  }
  standardise(texture);
  return texture;
}

}  // namespace thermorig::simulation
