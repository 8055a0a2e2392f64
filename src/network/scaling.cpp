// SPDX-License-Identifier: MIT
#include "thermorig/network/scaling.h"

#include <cassert>
#include <cmath>

#include "thermorig/core/frame.h"

namespace thermorig::network {

namespace {

/// Sums over pixels, about a temperature in their midst so that no digit is lost.
struct PixelSums {
  static constexpr double origin_c = 25.0;
  double count = 0.0, sum = 0.0, squares = 0.0;

  void add(std::span<const float> pixels) {
    for (const float temp_c : pixels) {
      const double off = temp_c - origin_c;
      sum += off;
      squares += off * off;
    }
    count += static_cast<double>(pixels.size());
  }
};

void add_valid_frames(const Acquisition& acquisition, PixelSums& sums) {
  const std::span<const float> pixels(acquisition.temp_c);
  for (std::size_t frame = 0; frame < acquisition.frames(); ++frame)
    if (acquisition.run[frame] != 0) sums.add(pixels.subspan(frame * frame_pixels, frame_pixels));
}

/// Mean of the block whose upper left pixel is at `row`, `column`.
float block_mean(std::span<const float> temp_c, std::size_t row, std::size_t column, std::size_t size) {
  float sum = 0.0F;
  for (std::size_t y = row; y < row + size; ++y)
    for (std::size_t x = column; x < column + size; ++x) sum += temp_c[y * frame_columns + x];
  return sum / static_cast<float>(size * size);
}

}  // namespace

Scaling scaling_of(std::span<const Acquisition> acquisitions, float label_scale_dps,
                   std::optional<std::size_t> without) {
  PixelSums sums;
  for (std::size_t index = 0; index < acquisitions.size(); ++index)
    if (index != without) add_valid_frames(acquisitions[index], sums);
  Scaling scaling{.label_scale_dps = label_scale_dps};
  if (sums.count == 0.0) return scaling;
  const double mean = sums.sum / sums.count;
  const double variance = sums.squares / sums.count - mean * mean;
  scaling.temp_mean_c = static_cast<float>(PixelSums::origin_c + mean);
  if (variance > 1e-12) scaling.temp_deviation_c = static_cast<float>(std::sqrt(variance));
  return scaling;
}

void prepare_frame(std::span<const float> temp_c, const network::Shape& shape, const Scaling& scaling,
                   std::span<float> out) {
  assert(temp_c.size() == frame_pixels && out.size() == shape.pixels());
  const auto size = static_cast<std::size_t>(shape.reduction);
  const auto left = static_cast<std::size_t>(shape.crop_left);
  const auto rows = static_cast<std::size_t>(shape.rows()),
             columns = static_cast<std::size_t>(shape.columns());
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t column = 0; column < columns; ++column)
      out[row * columns + column] =
          (block_mean(temp_c, row * size, left + column * size, size) - scaling.temp_mean_c) /
          scaling.temp_deviation_c;
}

std::vector<float> prepare(const Acquisition& acquisition, const network::Shape& shape,
                           const Scaling& scaling) {
  std::vector<float> prepared(acquisition.frames() * shape.pixels());
  const std::span<const float> pixels(acquisition.temp_c);
  const std::span<float> out(prepared);
  for (std::size_t frame = 0; frame < acquisition.frames(); ++frame)
    prepare_frame(pixels.subspan(frame * frame_pixels, frame_pixels), shape, scaling,
                  out.subspan(frame * shape.pixels(), shape.pixels()));
  return prepared;
}

}  // namespace thermorig::network
