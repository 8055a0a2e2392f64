// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/timing/lower_line.h"

#include <algorithm>
#include <cassert>

namespace thermorig::timing {

namespace {
/// Whether `b` lies on or above the line from `a` to `c` once each is raised by `curvature` x^2.
bool is_hidden(const Ceiling& a, const Ceiling& b, const Ceiling& c, double curvature) {
  const double u = b.x - a.x;
  const double v = c.x - a.x;
  const double b_s = b.y - a.y + curvature * u * u;
  const double c_s = c.y - a.y + curvature * v * v;
  return b_s * v >= c_s * u;
}

std::vector<Ceiling> lower_hull(std::span<const Ceiling> ceilings) {
  std::vector<Ceiling> hull(ceilings.begin(), ceilings.end());
  keep_lower_hull(hull, 0, 0.0);
  return hull;
}

/// Of the side of the hull that is at `x`, or of its first or last one. There are two points.
double slope_at(const std::vector<Ceiling>& hull, double x) {
  std::size_t right = 1;
  while (right + 1 < hull.size() && hull[right].x < x) ++right;
  return (hull[right].y - hull[right - 1].y) / (hull[right].x - hull[right - 1].x);
}
}  // namespace

void keep_lower_hull(std::vector<Ceiling>& ceilings, std::size_t first, double curvature) {
  std::size_t kept = first;
  for (std::size_t i = first; i < ceilings.size(); ++i) {
    const Ceiling next = ceilings[i];
    if (kept > first && ceilings[kept - 1].x >= next.x) {  // same place: the lower one counts
      if (ceilings[kept - 1].y <= next.y) continue;
      --kept;
    }
    while (kept >= first + 2 && is_hidden(ceilings[kept - 2], ceilings[kept - 1], next, curvature)) --kept;
    ceilings[kept++] = next;
  }
  ceilings.resize(kept);
}

double lower_line_slope(std::span<const Ceiling> ceilings, double fallback) {
  const std::vector<Ceiling> hull = lower_hull(ceilings);
  if (hull.size() < 2) return fallback;
  double sum = 0.0;
  for (const Ceiling& ceiling : ceilings) sum += ceiling.x - ceilings.front().x;
  return slope_at(hull, ceilings.front().x + sum / static_cast<double>(ceilings.size()));
}

Line highest_line(std::span<const Ceiling> ceilings, double middle, double slope_limit) {
  assert(!ceilings.empty());
  const std::vector<Ceiling> hull = lower_hull(ceilings);
  double slope = 0.0;
  if (middle <= hull.front().x)
    slope = -slope_limit;
  else if (middle >= hull.back().x)
    slope = slope_limit;
  else
    slope = std::clamp(slope_at(hull, middle), -slope_limit, slope_limit);
  Line line{middle, hull.front().y - slope * (hull.front().x - middle), slope};
  for (const Ceiling& point : hull) line.a = std::min(line.a, point.y - slope * (point.x - middle));
  return line;
}

}  // namespace thermorig::timing
