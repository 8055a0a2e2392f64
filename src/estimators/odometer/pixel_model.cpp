// SPDX-License-Identifier: MIT
#include "pixel_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "thermorig/core/statistics.h"

namespace thermorig::odometer {

namespace {

constexpr float stuck_after = 3.0F;       // halves in which a pixel shows the very same
constexpr float offset_prior = 15.0F;     // readings: noise of 0.6 K against constant errors of 0.16 K
constexpr float most_readings = 4000.0F;  // then what is older fades
constexpr float loaded_readings = 60.0F;  // that a map of before counts for
constexpr float variance_prior = 16.0F;   // readings for which a pixel counts as noisy as all
constexpr float common_share = 0.02F;     // of a half in the noise of all
constexpr float normal_median = 0.455F;   // of squares of normal ones, in units of their variance
constexpr float least_pixel_variance = 0.01F;

}  // namespace

HalfPixels PixelModel::corrected(const HalfFrame& half) {
  HalfPixels temp_c;
  HalfPixels &last = last_c_[half.parity], &repeats = repeats_[half.parity];
  for (std::size_t i = 0; i < half_pixels; ++i) {
    repeats[i] = half.temp_c[i] == last[i] ? repeats[i] + 1.0F : 0.0F;
    last[i] = half.temp_c[i];
    temp_c[i] = repeats[i] >= stuck_after ? std::numeric_limits<float>::quiet_NaN()
                                          : half.temp_c[i] - offset_c_[half.parity][i];
  }
  return temp_c;
}

void PixelModel::expect_noise(float variance_k2) {
  common_variance_ = heard_variance_ = std::max(common_variance_, variance_k2);
  variance_.fill(uniform(common_variance_));
}

void PixelModel::keep(Map& map) const {
  for (const std::size_t parity : {0U, 1U}) {
    const auto from = static_cast<std::ptrdiff_t>(parity * half_pixels);
    std::copy(offset_c_[parity].begin(), offset_c_[parity].end(), map.pixel_offset_k.begin() + from);
    std::copy(variance_[parity].begin(), variance_[parity].end(), map.pixel_variance_k2.begin() + from);
  }
}

void PixelModel::load(const Map& map) {
  *this = PixelModel();
  float sum = 0.0F;
  for (const std::size_t parity : {0U, 1U})
    for (std::size_t i = 0; i < half_pixels; ++i) {
      offset_c_[parity][i] = map.pixel_offset_k[parity * half_pixels + i];
      variance_[parity][i] = squares_[parity][i] = map.pixel_variance_k2[parity * half_pixels + i];
      count_[parity][i] = loaded_readings;
      sum += variance_[parity][i];
    }
  common_variance_ = sum / static_cast<float>(frame_pixels);
}

void PixelModel::learn(unsigned parity, const HalfPixels& residual, const HalfPixels& map_variance) {
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < half_pixels; ++i) {
    if (std::isnan(residual[i])) continue;
    const float limit = 16.0F * (variance_[parity][i] + map_variance[i]);
    const float square = std::min(limit, residual[i] * residual[i]) - map_variance[i];
    float& n = count_[parity][i];
    n = std::min(n + 1.0F, most_readings);
    offset_c_[parity][i] += residual[i] / (n + offset_prior);
    squares_[parity][i] += (square - squares_[parity][i]) / n;
    const float own = std::max(least_pixel_variance, squares_[parity][i]);
    variance_[parity][i] = (variance_prior * common_variance_ + n * own) / (variance_prior + n);
    sum += double{square};
    count += 1.0;
  }
  if (count < 0.25 * half_pixels) return;
  const auto mean = static_cast<float>(sum / count);
  common_variance_ += common_share * (std::max(least_pixel_variance, mean) - common_variance_);
}

/// By the median of a half's squares, less what the map explains of it.
void PixelModel::hear_noise(const HalfPixels& residual, const HalfPixels& map_variance) {
  HalfPixels squares;
  std::size_t compared = 0;
  for (std::size_t i = 0; i < half_pixels; ++i)
    if (!std::isnan(residual[i]))
      squares[compared++] = residual[i] * residual[i] - normal_median * map_variance[i];
  if (compared < half_pixels / 4) return;
  const float middle = reordering_median(std::span(squares).first(compared));
  const float heard = std::max(least_pixel_variance, middle / normal_median);
  heard_variance_ += common_share * (heard - heard_variance_);
}

}  // namespace thermorig::odometer
