// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

namespace thermorig::training {

/// In which order an epoch goes through the windows, and how it turns each.
struct EpochPlan {
  std::vector<std::uint32_t> order;
  std::vector<std::uint8_t> turns;  // bits of network::Turn, by place in the order
};

/// Depends on seed and epoch alone. `symmetries`: 1, 2 or 8, of which each window is shown in one.
EpochPlan epoch_plan(std::size_t windows, std::uint64_t seed, int epoch, int symmetries);

/// All windows as they come, none turned.
EpochPlan in_order(std::size_t windows);

}  // namespace thermorig::training
