// SPDX-License-Identifier: MIT
#include "thermorig/network/last_blocks.h"

#include <algorithm>
#include <cassert>

namespace thermorig::network {

void LastBlocks::push(std::span<const float> newest) {
  assert(newest.size() == size_);
  for (const std::size_t place : {next_, next_ + count_})
    std::copy(newest.begin(), newest.end(), values_.begin() + static_cast<std::ptrdiff_t>(place * size_));
  next_ = (next_ + 1) % count_;
}

}  // namespace thermorig::network
