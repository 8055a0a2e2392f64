// SPDX-License-Identifier: MIT
#include "lower_line.h"

#include <cstddef>
#include <vector>

namespace thermorig::timing {

namespace {
double mean_x(std::span<const Ceiling> ceilings) {
  double sum = 0.0;
  for (const Ceiling& ceiling : ceilings) sum += ceiling.x - ceilings.front().x;
  return ceilings.front().x + sum / static_cast<double>(ceilings.size());
}
}  // namespace

double lower_line_slope(std::span<const Ceiling> ceilings, double fallback) {
  if (ceilings.empty()) return fallback;
  const double middle = mean_x(ceilings);
  std::vector<Ceiling> hull(ceilings.begin(), ceilings.end());
  keep_lower_hull(hull, 0, 0.0);
  if (hull.size() < 2) return fallback;
  std::size_t right = 1;
  while (right + 1 < hull.size() && hull[right].x < middle) ++right;
  return (hull[right].y - hull[right - 1].y) / (hull[right].x - hull[right - 1].x);
}

}  // namespace thermorig::timing
