// SPDX-License-Identifier: MIT
#include "earlier_rates.h"

#include <algorithm>
#include <cmath>

namespace thermorig::likelihood {

namespace {

// Assumed: a motor holds its rate. A hand does not, and may, since the density of what is expected has heavy
// tails. With 100 the errors of faint rooms are a fifth larger; with 12 turns are told worse.
constexpr double change_dps2 = 25.0;

}  // namespace

void EarlierRates::add(const EarlierRate& earlier) {
  std::rotate(told_.begin(), told_.begin() + 1, told_.end());
  told_.back() = earlier;
  count_ = std::min(count_ + 1, told_.size());
}

std::optional<EarlierRate> EarlierRates::expected(HostTime begin, HostTime end) const {
  for (std::size_t i = 1; i <= count_; ++i) {
    EarlierRate earlier = told_[told_.size() - i];
    if (earlier.end > begin) continue;
    earlier.sigma_dps = std::hypot(earlier.sigma_dps, change_dps2 * to_s(end - earlier.end));
    return earlier;
  }
  return std::nullopt;
}

}  // namespace thermorig::likelihood
