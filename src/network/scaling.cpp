// SPDX-License-Identifier: MIT
#include "thermorig/network/scaling.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

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

constexpr int scaling_rounds = 4;
constexpr float outlier = 3.0F;             // deviations
constexpr double least_deviation_c = 0.01;  // of a window that shows nothing, without noise
constexpr float most = 4.0F;                // deviations that are left of any pixel

/// Sums over the pixels of a row, in all frames of a window, that count, about a mean; a lane a column, so
/// that they do not depend on how wide a processor's vectors are.
template <int columns>
struct RowSums {
  std::array<float, columns> count{}, sum{}, squares{};

  void add(const float* temp_c, float mean_c, float limit_c) {
    for (std::size_t x = 0; x < columns; ++x) {
      const float off = temp_c[x] - mean_c;
      const float counts = std::abs(off) <= limit_c ? 1.0F : 0.0F;
      count[x] += counts;
      sum[x] += counts * off;
      squares[x] += counts * off * off;
    }
  }

  static double total(const std::array<float, columns>& lanes) {
    double sum = 0.0;
    for (const float lane : lanes) sum += lane;
    return sum;
  }
};

template <int columns>
class WindowScaling {
 public:
  WindowScaling(std::span<float> degrees, const network::Shape& shape)
      : window_(degrees),
        frames_(static_cast<std::size_t>(shape.frames)),
        rows_(static_cast<std::size_t>(shape.rows())) {}

  void scale() {
    for (std::size_t row = 0; row < rows_; ++row) begin(row);
    for (int round = 0; round < scaling_rounds; ++round) refine();
    const auto inverse = static_cast<float>(1.0 / deviation_c_);
    for (std::size_t frame = 0; frame < frames_; ++frame)
      for (std::size_t row = 0; row < rows_; ++row) finish(at(frame, row), mean_c_[row], inverse);
  }

 private:
  float* at(std::size_t frame, std::size_t row) { return window_.data() + (frame * rows_ + row) * columns; }

  void begin(std::size_t row) {
    double sum = 0.0;
    for (std::size_t frame = 0; frame < frames_; ++frame)
      for (std::size_t x = 0; x < columns; ++x) sum += at(frame, row)[x];
    mean_c_[row] = static_cast<float>(sum / static_cast<double>(frames_ * columns));
  }

  void refine() {
    const float limit_c = static_cast<float>(outlier * deviation_c_);
    double count = 0.0, squares = 0.0;
    for (std::size_t row = 0; row < rows_; ++row) {
      RowSums<columns> sums;
      for (std::size_t frame = 0; frame < frames_; ++frame) sums.add(at(frame, row), mean_c_[row], limit_c);
      const double in_row = RowSums<columns>::total(sums.count);
      const double shift = RowSums<columns>::total(sums.sum) / std::max(in_row, 1.0);
      mean_c_[row] += static_cast<float>(shift);
      count += in_row;
      squares += RowSums<columns>::total(sums.squares) - in_row * shift * shift;
    }
    deviation_c_ = std::max(std::sqrt(std::max(squares, 0.0) / std::max(count, 1.0)), least_deviation_c);
  }

  static void finish(float* temp_c, float mean_c, float inverse) {
    for (std::size_t x = 0; x < columns; ++x)
      temp_c[x] = std::clamp((temp_c[x] - mean_c) * inverse, -most, most);
  }

  std::span<float> window_;
  std::size_t frames_, rows_;
  std::array<float, frame_rows> mean_c_{};
  double deviation_c_ = std::numeric_limits<float>::max() / outlier;
};

}  // namespace

Scaling scaling_by_window(float label_scale_dps) {
  return {.label_scale_dps = label_scale_dps, .by_window = true, .frame_period_s = 0.125F};
}

void scale_window(std::span<float> degrees, const network::Shape& shape) {
  assert(degrees.size() == shape.inputs());
  switch (shape.columns()) {
    case 32:
      return WindowScaling<32>(degrees, shape).scale();
    case 16:
      return WindowScaling<16>(degrees, shape).scale();
    default:
      assert(shape.columns() == 10);
      return WindowScaling<10>(degrees, shape).scale();
  }
}

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
