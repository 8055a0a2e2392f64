// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <vector>

#include "thermorig/core/statistics.h"
#include "thermorig/core/sync.h"

namespace thermorig::fit {

/// Mean skew of the knots, and how far they wander about it; 0 without knots.
inline void summarise_skew(ClockReport& report) {
  if (report.knots.empty()) return;
  const auto count = static_cast<double>(report.knots.size());
  double sum = 0.0, squares = 0.0;
  for (const ClockKnot& knot : report.knots) sum += knot.skew_ppm;
  report.skew_ppm = sum / count;
  for (const ClockKnot& knot : report.knots) squares += std::pow(knot.skew_ppm - report.skew_ppm, 2);
  report.wander_ppm = std::sqrt(squares / count);
}

/// `late_s`: of each chunk; they are put in another order.
template <typename Number>
void summarise_lateness(std::vector<Number>& late_s, ClockReport& report) {
  report.late_p50_us = lower_quantile(late_s, 0.5) * 1e6;
  report.late_p95_us = lower_quantile(late_s, 0.95) * 1e6;
  report.late_max_us = lower_quantile(late_s, 1.0) * 1e6;
}

}  // namespace thermorig::fit
