// SPDX-License-Identifier: MIT
#include "heading_trust.h"

#include <algorithm>
#include <cmath>

namespace thermorig::odometer {

namespace {

constexpr double view_deg = 5.0;  // a view that was turned by as much is another one
constexpr int fewest_views = 32;  // 4 s at 8 halves a second
constexpr double range_deg = 60.0;
constexpr double least_structure = 40.0;                    // of a half: before walls all maps are alike
constexpr double left_of_same = 0.08, left_of_other = 0.2;  // of the structure: what is left of it
constexpr double used_of_same = 0.7;                        // share of the halves

}  // namespace

/// A rig at rest shows one view again and again, which may be like another one of any room.
void MapCheck::add(const HalfResult& result, double heading_deg) {
  if (!result.is_judged) return;
  if (views_ > 0 && std::abs(heading_deg - last_deg_) < view_deg) return;
  if (views_++ == 0) lowest_deg_ = highest_deg_ = heading_deg;
  last_deg_ = heading_deg;
  lowest_deg_ = std::min(lowest_deg_, heading_deg);
  highest_deg_ = std::max(highest_deg_, heading_deg);
  left_ += result.explained.left;
  structure_ += result.explained.structure;
  used_ += result.is_used ? 1 : 0;
}

MapCheck::Verdict MapCheck::verdict() const {
  const bool tells = views_ >= fewest_views && structure_ >= least_structure * views_;
  if (!tells || highest_deg_ - lowest_deg_ < range_deg) return Verdict::open;
  if (left_ > left_of_other * structure_ || used_ < used_of_same * views_) return Verdict::other;
  return left_ < left_of_same * structure_ ? Verdict::same : Verdict::open;
}

}  // namespace thermorig::odometer
