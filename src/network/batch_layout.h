// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "thermorig/network/weights.h"

namespace thermorig::network {

/// Where the training kernels want each weight, and so its gradient and moments: those of dense layers in
/// blocks of 32 features, the two heads' first layers as one matrix; the others as in `Weights`, each tensor
/// from a multiple of 16 on. What fills up stays 0.
class BatchLayout {
 public:
  explicit BatchLayout(const Shape& shape);

  std::size_t size() const { return size_; }    // of all, in floats
  std::size_t small() const { return small_; }  // where the tensors that are no dense layer's weights begin
  int blocks() const { return blocks_; }        // of features
  int heads() const { return heads_; }

  // Where each tensor begins.
  std::size_t dense1() const { return 0; }        // (blocks, heads * 120, 32)
  std::size_t dense2() const { return dense2_; }  // (4, 80, 32)
  std::size_t conv1_weight() const { return starts_[0]; }
  std::size_t conv1_bias() const { return starts_[1]; }
  std::size_t conv2_weight() const { return starts_[2]; }
  std::size_t conv2_bias() const { return starts_[3]; }
  std::size_t speed1_bias() const { return starts_[5]; }
  std::size_t speed2_bias() const { return starts_[7]; }
  std::size_t speed3_weight() const { return starts_[8]; }
  std::size_t speed3_bias() const { return starts_[9]; }
  std::size_t gain1_bias() const { return starts_[11]; }    // these three: only with
  std::size_t gain2_weight() const { return starts_[12]; }  // fusion
  std::size_t gain2_bias() const { return starts_[13]; }

  void pack(std::span<const float> canonical, std::span<float> packed) const;
  void unpack(std::span<const float> packed, std::span<float> canonical) const;

 private:
  std::size_t place(std::size_t tensor, std::size_t index) const;

  std::vector<Tensor> tensors_;
  std::vector<std::size_t> starts_;  // of each tensor; of speed1, speed2 and gain1 see place()
  std::size_t features_ = 0, dense2_ = 0, small_ = 0, size_ = 0;
  int blocks_ = 0, heads_ = 1;
};

}  // namespace thermorig::network
