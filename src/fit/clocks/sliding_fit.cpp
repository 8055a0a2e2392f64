// SPDX-License-Identifier: MIT
#include "sliding_fit.h"

#include <algorithm>
#include <cmath>

#include "thermorig/pipeline/timing/least_lateness.h"

namespace thermorig::fit {

using namespace timing;

namespace {
// A clock that wanders by 1000 ppm at most (an RC oscillator) is well followed by a parabola over 22 s. What
// a parabola cannot follow of a random walk of the rate grows with wander * length^1.5.
constexpr double reference_window_s = 22.0;
constexpr double shortest_window_s = 8.0;
constexpr double longest_window_s = 100.0;
constexpr double shortest_block_s = 0.25;
// Over a window the rate changes by no more than this share of the wander: what a walk of the rate does in so
// much less than it takes to wander about. It keeps the ends, where the curve leaves its window, in place.
constexpr double rate_change_share = 0.4;
}  // namespace

SlidingWindow SlidingWindow::of(double wander_ppm, double message_rate_hz) {
  const double wander = std::max(wander_ppm, 1.0) / reference_wander_ppm;
  double length_s =
      std::clamp(reference_window_s * std::pow(wander, -2.0 / 3.0), shortest_window_s, longest_window_s);
  if (message_rate_hz > 0.0) length_s = std::max(length_s, messages_a_window / message_rate_hz);
  return {length_s, std::max(length_s / blocks_a_window, shortest_block_s)};
}

SlidingFit::SlidingFit(std::span<const Ceiling> ceilings, const SlidingWindow& window, double slope_limit)
    : window_(window), limits_{slope_limit, 0.5 * rate_change_share * slope_limit / window.length_s} {
  reduce(ceilings, window.block_s);
  knots_.reserve(blocks_.size());
  for (std::size_t block = 0; block < blocks_.size(); ++block) fit_knot(block);
}

void SlidingFit::reduce(std::span<const Ceiling> ceilings, double block_s) {
  for (std::size_t i = 0; i < ceilings.size();) {
    Block block{reduced_.size(), 0, ceilings[i].x, ceilings[i].x};
    for (; i < ceilings.size() && ceilings[i].x < block.first_x + block_s; ++i) {
      reduced_.push_back(ceilings[i]);
      block.last_x = ceilings[i].x;
    }
    keep_lower_hull(reduced_, block.begin, limits_.curvature);
    block.end = reduced_.size();
    blocks_.push_back(block);
  }
}

/// Places of the ceilings of blocks `begin` .. `end` - 1, taken to lie evenly within a block.
Moments SlidingFit::moments(std::size_t begin, std::size_t end, double middle) const {
  Moments sum;
  for (std::size_t i = begin; i < end; ++i) {
    const double x = 0.5 * (blocks_[i].first_x + blocks_[i].last_x) - middle;
    const double width = blocks_[i].last_x - blocks_[i].first_x;
    sum.first += x;
    sum.second += x * x + width * width / 12.0;
  }
  const auto count = static_cast<double>(end - begin);
  return {sum.first / count, sum.second / count};
}

void SlidingFit::fit_knot(std::size_t block) {
  const double x = 0.5 * (blocks_[block].first_x + blocks_[block].last_x);
  // At the ends of the segment the window stays whole and the knot moves away from its middle.
  const double first_x = blocks_.front().first_x;
  const double last_x = std::max(first_x, blocks_.back().last_x - window_.length_s);
  const double begin_x = std::clamp(x - 0.5 * window_.length_s, first_x, last_x);
  const auto before = [](const Block& b, double value) { return b.last_x < value; };
  const auto after = [](double value, const Block& b) { return value < b.first_x; };
  const auto begin = std::lower_bound(blocks_.begin(), blocks_.end(), begin_x, before);
  const auto end = std::upper_bound(begin, blocks_.end(), begin_x + window_.length_s, after);
  const double middle = begin_x + 0.5 * window_.length_s;
  const std::span window(reduced_.data() + begin->begin, (end - 1)->end - begin->begin);
  const Moments where = moments(static_cast<std::size_t>(begin - blocks_.begin()),
                                static_cast<std::size_t>(end - blocks_.begin()), middle);
  const Parabola curve = highest_below(window, middle, 0.5 * window_.length_s, where, limits_);
  knots_.push_back(
      {x, curve, rise_without_holding(window, curve, x, 0.5 * window_.length_s, where, limits_)});
}

void SlidingFit::seek(double x) {
  while (place_ > 0 && x < knots_[place_].x) --place_;
  while (place_ + 1 < knots_.size() && x >= knots_[place_ + 1].x) ++place_;
}

/// Weight of the knot after the place, 0 to 1.
double SlidingFit::smooth_share(double x) const {
  if (place_ + 1 == knots_.size()) return 0.0;
  const double left_x = knots_[place_].x;
  const double share = std::clamp((x - left_x) / (knots_[place_ + 1].x - left_x), 0.0, 1.0);
  return share * share * (3.0 - 2.0 * share);
}

double SlidingFit::at(double x) {
  seek(x);
  const double share = smooth_share(x);
  const double left = knots_[place_].curve.at(x);
  return share == 0.0 ? left : (1.0 - share) * left + share * knots_[place_ + 1].curve.at(x);
}

double SlidingFit::blend(std::span<const double> values, double x) {
  seek(x);
  const double share = smooth_share(x);
  return share == 0.0 ? values[place_] : (1.0 - share) * values[place_] + share * values[place_ + 1];
}

double SlidingFit::slope(double x) {
  seek(x);
  return knots_[place_].curve.slope(x);
}

}  // namespace thermorig::fit
