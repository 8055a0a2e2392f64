// SPDX-License-Identifier: MIT
#include <cmath>
#include <utility>

#include "scene_shapes.h"

namespace thermorig::simulation {
namespace {

using Ring = std::vector<float>;  // a value for each azimuth

float smooth(float x) {
  return x * x * (3.0F - 2.0F * x);
}

/// Smooth random values around the panorama that change over `cells` cells.
Ring random_ring(Random& random, int cells) {
  std::vector<float> nodes(static_cast<std::size_t>(cells));
  for (float& node : nodes) node = static_cast<float>(random.normal());
  Ring ring(Panorama::azimuths);
  const float cells_a_step = static_cast<float>(cells) / static_cast<float>(Panorama::azimuths);
  for (std::size_t azimuth = 0; azimuth < ring.size(); ++azimuth) {
    const float x = static_cast<float>(azimuth) * cells_a_step;
    const auto left = static_cast<std::size_t>(x);
    const float part = smooth(x - static_cast<float>(left));
    ring[azimuth] = nodes[left] + part * (nodes[(left + 1) % nodes.size()] - nodes[left]);
  }
  return ring;
}

/// Adds noise on a lattice of square cells, so many of them around the panorama.
void add_octave(std::vector<float>& texture, Random& random, int cells, float amplitude) {
  const double cells_a_row = cells * Panorama::elevation_step_deg / 360.0;
  Ring below = random_ring(random, cells);
  Ring above = random_ring(random, cells);
  int below_cell = 0;
  for (int row = 0; row < Panorama::elevations; ++row) {
    const double y = row * cells_a_row;
    for (; below_cell < static_cast<int>(y); ++below_cell)
      below = std::exchange(above, random_ring(random, cells));
    const float part = smooth(static_cast<float>(y - below_cell));
    float* out = &texture[static_cast<std::size_t>(row) * Panorama::azimuths];
    for (std::size_t azimuth = 0; azimuth < below.size(); ++azimuth)
      out[azimuth] += amplitude * (below[azimuth] + part * (above[azimuth] - below[azimuth]));
  }
}

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
    const int cells = 8 << octave;  // of 45 down to 0.7 degrees
    add_octave(texture, random, cells, static_cast<float>(std::exp2(-0.2 * octave)));
  }
  standardise(texture);
  return texture;
}

}  // namespace thermorig::simulation
