// SPDX-License-Identifier: MIT
#include "batch_layout.h"

#include "kernels/training_kernels.h"

namespace thermorig::network {

namespace {

constexpr std::size_t speed1 = 4, speed2 = 6, gain1 = 10;  // among tensors_of

std::size_t filled_up(std::size_t size, std::size_t unit) {
  return (size + unit - 1) / unit * unit;
}

/// Of weight (row, feature) in (blocks, rows, 32).
std::size_t in_blocks(std::size_t row, std::size_t feature, std::size_t rows) {
  return (feature / block * rows + row) * block + feature % block;
}

}  // namespace

BatchLayout::BatchLayout(const Shape& shape)
    : tensors_(tensors_of(shape)),
      starts_(tensors_.size()),
      features_(static_cast<std::size_t>(shape.features())),
      blocks_((shape.features() + block - 1) / block),
      heads_(shape.fusion ? 2 : 1) {
  dense2_ = static_cast<std::size_t>(blocks_ * heads_ * hidden1 * block);
  small_ = dense2_ + hidden2 * filled_up(hidden1, block);
  size_ = small_;
  for (std::size_t tensor = 0; tensor < tensors_.size(); ++tensor) {
    if (tensor == speed1 || tensor == speed2 || tensor == gain1) continue;
    starts_[tensor] = size_;
    size_ += filled_up(tensors_[tensor].size, 16);
  }
}

std::size_t BatchLayout::place(std::size_t tensor, std::size_t index) const {
  const std::size_t rows = static_cast<std::size_t>(heads_) * hidden1;
  if (tensor == speed1) return in_blocks(index / features_, index % features_, rows);
  if (tensor == gain1) return in_blocks(hidden1 + index / features_, index % features_, rows);
  if (tensor == speed2) return dense2_ + in_blocks(index / hidden1, index % hidden1, hidden2);
  return starts_[tensor] + index;
}

void BatchLayout::pack(std::span<const float> canonical, std::span<float> packed) const {
  for (std::size_t t = 0; t < tensors_.size(); ++t)
    for (std::size_t i = 0; i < tensors_[t].size; ++i)
      packed[place(t, i)] = canonical[tensors_[t].offset + i];
}

void BatchLayout::unpack(std::span<const float> packed, std::span<float> canonical) const {
  for (std::size_t t = 0; t < tensors_.size(); ++t)
    for (std::size_t i = 0; i < tensors_[t].size; ++i)
      canonical[tensors_[t].offset + i] = packed[place(t, i)];
}

}  // namespace thermorig::network
