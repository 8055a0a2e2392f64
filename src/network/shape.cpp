// SPDX-License-Identifier: MIT
#include "thermorig/network/shape.h"

#include "thermorig/network/weights.h"

namespace thermorig::network {

namespace {

bool within(int value, int least, int most) {
  return least <= value && value <= most;
}

}  // namespace

std::optional<std::string> fault_of(const Shape& shape) {
  if (!within(shape.frames, min_frames, max_frames)) return "a window has 2 to 6 frames";
  if (!within(shape.reduction, min_reduction, max_reduction)) return "pixels are averaged 1x1, 2x2 or 3x3";
  if (!within(shape.padding1, 0, 2) || !within(shape.padding2, 0, 2))
    return "a convolution is padded by 0 to 2";
  if (!within(shape.crop_left, 0, 32 % shape.reduction))
    return "more columns would be cropped than averaging leaves over";
  if (shape.pooled_rows() < 1 || shape.rows2() < 1 || shape.columns2() < 1)
    return "with so little padding nothing is left after the second convolution";
  return std::nullopt;
}

std::size_t weight_count(const Shape& shape) {
  const auto tensors = tensors_of(shape);
  return tensors.back().offset + tensors.back().size;
}

std::uint64_t multiply_adds(const Shape& shape) {
  const auto product = [](auto... factor) {
    return (std::uint64_t{1} * ... * static_cast<std::uint64_t>(factor));
  };
  const int window = kernel_size * kernel_size;
  const std::uint64_t convolutions =
      product(shape.rows1(), shape.columns1(), filters1, shape.frames, window) +
      product(shape.rows2(), shape.columns2(), filters2, filters1, window);
  const std::uint64_t speed = product(shape.features(), hidden1) + product(hidden1, hidden2) + hidden2;
  const std::uint64_t gain = product(shape.features(), hidden1) + hidden1;
  return convolutions + speed + (shape.fusion ? gain : 0);
}

}  // namespace thermorig::network
