// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

namespace thermorig::network {

/// The last `count` blocks of `size` numbers, as one array, oldest first; NaN before there were so many.
/// Every block is kept twice, `count` places apart, so that the last ones stand in a row wherever the newest
/// is.
class LastBlocks {
 public:
  LastBlocks(std::size_t count, std::size_t size)
      : count_(count), size_(size), values_(2 * count * size, std::numeric_limits<float>::quiet_NaN()) {}

  void push(std::span<const float> block);
  void push(float number) { push({&number, 1}); }

  std::span<const float> all() const { return std::span(values_).subspan(next_ * size_, count_ * size_); }

 private:
  std::size_t count_, size_;
  std::size_t next_ = 0;  // place of the oldest, which the next block replaces
  std::vector<float> values_;
};

}  // namespace thermorig::network
