// SPDX-License-Identifier: MIT
#include "thermorig/windows/last_blocks.h"

#include <algorithm>
#include <cassert>

namespace thermorig::windows {

void LastBlocks::push(std::span<const float> block) {
  assert(block.size() == size_);
  for (const std::size_t place : {next_, next_ + count_})
    std::copy(block.begin(), block.end(), values_.begin() + static_cast<std::ptrdiff_t>(place * size_));
  next_ = (next_ + 1) % count_;
}

}  // namespace thermorig::windows
