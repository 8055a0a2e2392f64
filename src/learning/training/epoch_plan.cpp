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
  EpochPlan plan{.order = std::vector<std::uint32_t>(windows), .mirrored = std::vector<bool>(windows, false)};
  std::iota(plan.order.begin(), plan.order.end(), 0U);
  return plan;
}

EpochPlan epoch_plan(std::size_t windows, std::uint64_t seed, int epoch, bool mirror) {
  const auto number = static_cast<std::uint64_t>(epoch);
  EpochPlan plan = in_order(windows);
  shuffle(plan.order, Draw(seed, "order", number));
  if (!mirror) return plan;
  Draw draw(seed, "mirror", number);
  for (std::size_t place = 0; place < windows; ++place) plan.mirrored[place] = draw.coin();
  return plan;
}

}  // namespace thermorig::training
