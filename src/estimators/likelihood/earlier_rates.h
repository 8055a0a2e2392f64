// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <optional>

#include "speed_table.h"
#include "thermorig/core/time.h"

namespace thermorig::likelihood {

/// The rate that a window told by its own images: what was expected before it is not in it.
struct EarlierRate {
  HostTime end{};  // of its exposures
  double rate_dps = 0.0, sigma_dps = 0.0;
};

/// What the windows before have told: what is expected of the next one. Each tells by itself, so that one
/// that is wrong is gone as soon as there is another.
class EarlierRates {
 public:
  void add(const EarlierRate& earlier);

  /// The newest one that ended before that time: it shares no half with a window that begins then. Its sigma
  /// holds that the rate has changed since, until `end`.
  std::optional<EarlierRate> expected(HostTime begin, HostTime end) const;

 private:
  std::array<EarlierRate, most_halves> told_{};  // the newest is the last one; one less may share halves
  std::size_t count_ = 0;
};

}  // namespace thermorig::likelihood
