// SPDX-License-Identifier: MIT
#include "epoch_plan.h"

#include <numeric>
#include <utility>

#include "draw.h"

namespace thermorig::training {

namespace {

/// Fisher and Yates.
void shuffle(std::vector<std::uint32_t>& order, Draw draw) {
  for (std::size_t left = order.size(); left > 1; --left) std::swap(order[left - 1], order[draw.below(left)]);
}

}  // namespace

EpochPlan in_order(std::size_t windows) {
  EpochPlan plan{.order = std::vector<std::uint32_t>(windows),
                 .turns = std::vector<std::uint8_t>(windows, 0)};
  std::iota(plan.order.begin(), plan.order.end(), 0U);
  return plan;
}

EpochPlan epoch_plan(std::size_t windows, std::uint64_t seed, int epoch, int symmetries) {
  const auto number = static_cast<std::uint64_t>(epoch);
  EpochPlan plan = in_order(windows);
  shuffle(plan.order, Draw(seed, "order", number));
  if (symmetries == 1) return plan;
  Draw draw(seed, "mirror", number);
  for (std::uint8_t& turn : plan.turns) turn = draw.turn(symmetries);
  return plan;
}

}  // namespace thermorig::training
