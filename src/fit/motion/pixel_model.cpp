// SPDX-License-Identifier: MIT
#include "pixel_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "thermorig/core/statistics.h"

namespace thermorig::motion {
namespace {

constexpr double frozen_variance = 1e-4;  // K2: no living pixel is so quiet
constexpr float noisy_pixel = 9.0F;       // times the median variance: left out
constexpr float quiet_pixel = 0.25F;      // no pixel counts more than four
constexpr float least_variance = 1e-9F;
constexpr std::ptrdiff_t neighbours = 2;  // pixels either way
constexpr float unknown = std::numeric_limits<float>::quiet_NaN();

using FramePixels = std::array<float, frame_pixels>;

std::size_t frame_index(std::size_t i, unsigned parity) {
  const std::size_t column = i / half_rows;
  return row_of(column, i % half_rows, parity) * frame_columns + column;
}

/// Of the pixels of a half-frame.
struct Moments {
  std::array<double, half_pixels> count{};
  std::array<double, half_pixels> sum{};
  std::array<double, half_pixels> square{};
  void add(const HalfView& view) {
    for (std::size_t i = 0; i < half_pixels; ++i) {
      const double counted = view.trust[i] == 0.0F ? 0.0 : 1.0;
      const double temp_c = counted * static_cast<double>(view.temp_c[i]);
      count[i] += counted;
      sum[i] += temp_c;
      square[i] += temp_c * temp_c;
    }
  }
  float mean_if_alive(std::size_t i) const {
    if (count[i] < 2.0) return unknown;
    const double mean = sum[i] / count[i];
    return square[i] / count[i] - mean * mean > frozen_variance ? static_cast<float>(mean) : unknown;
  }
};

FramePixels mean_frame(std::span<const HalfView> views) {
  std::array<Moments, 2> moments;
  for (const HalfView& view : views) moments[view.half.parity].add(view);
  FramePixels mean{};
  for (const unsigned parity : {0U, 1U})
    for (std::size_t i = 0; i < half_pixels; ++i)
      mean[frame_index(i, parity)] = moments[parity].mean_if_alive(i);
  return mean;
}

float median_around(const FramePixels& frame, std::size_t index) {
  const auto row = static_cast<std::ptrdiff_t>(index / frame_columns);
  const auto column = static_cast<std::ptrdiff_t>(index % frame_columns);
  std::vector<float> around;
  for (std::ptrdiff_t y = row - neighbours; y <= row + neighbours; ++y)
    for (std::ptrdiff_t x = column - neighbours; x <= column + neighbours; ++x) {
      if (y < 0 || x < 0 || y >= std::ptrdiff_t{frame_rows} || x >= std::ptrdiff_t{frame_columns}) continue;
      const float temp_c = frame[static_cast<std::size_t>(y) * frame_columns + static_cast<std::size_t>(x)];
      if (!std::isnan(temp_c)) around.push_back(temp_c);
    }
  return reordering_median(around);
}

}  // namespace

PixelModel::PixelModel(std::span<const HalfView> views) {
  const FramePixels mean = mean_frame(views);
  for (const unsigned parity : {0U, 1U})
    for (std::size_t i = 0; i < half_pixels; ++i) {
      const std::size_t pixel = frame_index(i, parity);
      if (std::isnan(mean[pixel])) continue;
      weight_[parity][i] = 1.0F;
      offset_c_[parity][i] = mean[pixel] - median_around(mean, pixel);
    }
}

void PixelModel::read(const HalfView& view, float half_offset_c, Readings& readings) const {
  const unsigned parity = view.half.parity;
  for (std::size_t column = 0; column < frame_columns; ++column) {
    column_of(readings.value_c, column) =
        column_of(view.temp_c, column) - column_of(offset_c_[parity], column) - half_offset_c;
    column_of(readings.weight, column) = column_of(weight_[parity], column) * column_of(view.trust, column);
  }
}

void PixelModel::Residuals::add(const HalfPixels& residual, const HalfPixels& weights) {
  for (std::size_t column = 0; column < frame_columns; ++column) {
    const ColumnPixels left = column_of(residual, column);
    const ColumnPixels weighted = column_of(weights, column) * left;
    column_of(sum, column) += weighted;
    column_of(square, column) += weighted * left;
    column_of(weight, column) += column_of(weights, column);
  }
}

void PixelModel::learn(const std::array<Residuals, 2>& residuals) {
  std::vector<float> variances;
  for (const Residuals& half : residuals)
    for (std::size_t i = 0; i < half_pixels; ++i)
      if (half.weight[i] > 0.0F) variances.push_back(half.square[i] / half.weight[i]);
  if (variances.empty()) return;
  const float typical = std::max(least_variance, reordering_median(variances));
  for (const unsigned parity : {0U, 1U})
    for (std::size_t i = 0; i < half_pixels; ++i) {
      const Residuals& half = residuals[parity];
      if (half.weight[i] <= 0.0F) continue;
      offset_c_[parity][i] += half.sum[i] / half.weight[i];
      const float variance = std::max(quiet_pixel, half.square[i] / half.weight[i] / typical);
      weight_[parity][i] = variance > noisy_pixel ? 0.0F : 1.0F / variance;
    }
}

}  // namespace thermorig::motion
