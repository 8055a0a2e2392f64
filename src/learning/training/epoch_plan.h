// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

namespace thermorig::training {

/// In which order an epoch goes through the windows, and which it sees mirrored.
struct EpochPlan {
  std::vector<std::uint32_t> order;
  std::vector<bool> mirrored;  // by place in the order
};

/// Depends on seed and epoch alone.
EpochPlan epoch_plan(std::size_t windows, std::uint64_t seed, int epoch, bool mirror);

/// All windows as they come, none mirrored.
EpochPlan in_order(std::size_t windows);

}  // namespace thermorig::training
