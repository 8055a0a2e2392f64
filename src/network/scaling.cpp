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
  for_each_frame(acquisition, [&](std::size_t frame, std::span<const float> temp_c) {
    if (acquisition.run[frame] != 0) sums.add(temp_c);
  });
}

/// Mean of the block whose upper left pixel is `temp_c`.
template <std::size_t size>
float block_mean(const float* temp_c) {
  float sum = 0.0F;
  for (std::size_t y = 0; y < size; ++y)
    for (std::size_t x = 0; x < size; ++x) sum += temp_c[y * frame_columns + x];
  return sum / static_cast<float>(size * size);
}

/// The size is known when this is compiled: a training that reads from a disk does it for each window.
template <std::size_t size>
void prepare_blocks(const float* temp_c, const network::Shape& shape, const Scaling& scaling, float* out) {
  const auto rows = static_cast<std::size_t>(shape.rows()),
             columns = static_cast<std::size_t>(shape.columns());
  const float mean_c = scaling.temp_mean_c, deviation_c = scaling.temp_deviation_c;
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t column = 0; column < columns; ++column)
      out[row * columns + column] =
          (block_mean<size>(temp_c + row * size * frame_columns + column * size) - mean_c) / deviation_c;
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
  const float* const first = temp_c.data() + shape.crop_left;
  switch (shape.reduction) {
    case 1:
      return prepare_blocks<1>(first, shape, scaling, out.data());
    case 2:
      return prepare_blocks<2>(first, shape, scaling, out.data());
    default:
      assert(shape.reduction == 3);
      return prepare_blocks<3>(first, shape, scaling, out.data());
  }
}

std::vector<float> prepare(const Acquisition& acquisition, const network::Shape& shape,
                           const Scaling& scaling) {
  std::vector<float> prepared(acquisition.frames() * shape.pixels());
  const std::span<float> out(prepared);
  for_each_frame(acquisition, [&](std::size_t frame, std::span<const float> temp_c) {
    prepare_frame(temp_c, shape, scaling, out.subspan(frame * shape.pixels(), shape.pixels()));
  });
  return prepared;
}

}  // namespace thermorig::network
