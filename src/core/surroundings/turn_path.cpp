// SPDX-License-Identifier: MIT
#include "thermorig/core/surroundings/turn_path.h"

#include <algorithm>
#include <cmath>

namespace thermorig {

namespace {
constexpr int points = 24;           // of an exposure
constexpr std::size_t near_to = 32;  // knots
}  // namespace

void TurnPath::add(double time_s, double rate_dps, double unseen_deg2) {
  Knot knot{.time_s = time_s, .rate_dps = rate_dps, .unseen_deg2 = unseen_deg2};
  if (has_begun()) {
    const Knot& last = newest();
    const double step_s = time_s - last.time_s;
    knot.turned_deg = last.turned_deg + 0.5 * (last.rate_dps + rate_dps) * step_s;
    knot.unseen_deg2 += last.unseen_deg2;
    knot.sum_deg_s = last.sum_deg_s + 0.5 * (last.turned_deg + knot.turned_deg) * step_s;
  }
  knots_[count_++ % kept_] = knot;
}

/// The place of the first knot after a time. Samples come evenly: it lies where it should, or all are
/// searched.
std::size_t TurnPath::after(double time_s) const {
  std::size_t low = first(), high = count_;
  const double share = (time_s - at(low).time_s) / (newest().time_s - at(low).time_s);
  if (share > 0.0 && share < 1.0) {
    const std::size_t middle = low + static_cast<std::size_t>(share * static_cast<double>(high - low));
    const std::size_t from = std::max(low + near_to, middle) - near_to, to = std::min(middle + near_to, high);
    if (at(from).time_s <= time_s && at(to - 1).time_s > time_s) {
      low = from;
      high = to;
    }
  }
  while (low < high) {
    const std::size_t middle = low + (high - low) / 2;
    if (at(middle).time_s > time_s)
      high = middle;
    else
      low = middle + 1;
  }
  return low;
}

/// The same, if it is that of `from` or one of the next.
std::size_t TurnPath::after(double time_s, std::size_t from) const {
  while (from < count_ && at(from).time_s <= time_s) ++from;
  return from;
}

TurnPath::Knot TurnPath::until(double time_s) const {
  return until(time_s, after(time_s));
}

/// `later`: the place of the first knot after it.
TurnPath::Knot TurnPath::until(double time_s, std::size_t later) const {
  if (later == first() || later == count_) {
    Knot knot = at(later == count_ ? count_ - 1 : later);
    knot.turned_deg += knot.rate_dps * (time_s - knot.time_s);
    knot.time_s = time_s;
    return knot;
  }
  const Knot &a = at(later - 1), &b = at(later);
  const double step_s = time_s - a.time_s;
  const double slope = (b.rate_dps - a.rate_dps) / (b.time_s - a.time_s);
  return {.time_s = time_s,
          .turned_deg = a.turned_deg + a.rate_dps * step_s + 0.5 * slope * step_s * step_s,
          .rate_dps = a.rate_dps + slope * step_s,
          .unseen_deg2 = b.unseen_deg2};
}

void TurnPath::turned(double from_s, double step_s, std::span<double> turned_deg) const {
  std::size_t later = after(from_s);
  for (std::size_t i = 0; i < turned_deg.size(); ++i) {
    const double time_s = from_s + static_cast<double>(i) * step_s;
    later = after(time_s, later);
    turned_deg[i] = until(time_s, later).turned_deg;
  }
}

ExposedTurn TurnPath::over(double begin_s, double end_s) const {
  ExposedTurn turn{.begin_s = begin_s, .end_s = end_s};
  std::size_t later = after(begin_s);
  const Knot first = until(begin_s, later), last = until(end_s);
  turn.begin_deg = first.turned_deg;
  turn.end_deg = last.turned_deg;
  turn.first_dps = first.rate_dps;
  turn.last_dps = last.rate_dps;
  turn.mean_s = 0.5 * (begin_s + end_s);
  double sum_deg = 0.0, squares_deg2 = 0.0, products = 0.0, first_deg = 0.0, last_deg = 0.0;
  for (int i = 0; i < points; ++i) {
    const double off_s = (end_s - begin_s) * ((i + 0.5) / points - 0.5);
    later = after(turn.mean_s + off_s, later);
    const double deg = until(turn.mean_s + off_s, later).turned_deg - turn.begin_deg;
    sum_deg += deg;
    squares_deg2 += deg * deg;
    products += deg * off_s;
    turn.variance_s2 += off_s * off_s / points;
    if (i == points / 3) first_deg = deg;
    if (i == points - 1 - points / 3) last_deg = deg;
  }
  const double mean_deg = sum_deg / points;
  turn.mean_deg = turn.begin_deg + mean_deg;
  turn.variance_deg2 = squares_deg2 / points - mean_deg * mean_deg;
  turn.covariance = products / points;
  constexpr int third = points / 3;
  const double third_s = (end_s - begin_s) * (third + 0.5) / points;
  turn.change_dps = (turn.end_deg - turn.begin_deg - last_deg) / third_s - first_deg / third_s;
  return turn;
}

/// `turned_deg` and `sum_deg_s` alone.
TurnPath::Knot TurnPath::along_chords(double time_s) const {
  const std::size_t later = after(time_s);
  Knot knot = at(later == first() ? later : later - 1);
  const double since_s = time_s - knot.time_s, from_deg = knot.turned_deg;
  if (later != first() && later != count_) {
    const Knot& next = at(later);
    knot.turned_deg = std::lerp(from_deg, next.turned_deg, since_s / (next.time_s - knot.time_s));
  }
  knot.sum_deg_s += 0.5 * (from_deg + knot.turned_deg) * since_s;
  return knot;
}

TurnPath::Mean TurnPath::mean_over(double begin_s, double end_s) const {
  const Knot begin = along_chords(begin_s), end = along_chords(end_s);
  const double length_s = end_s - begin_s;
  return {(end.sum_deg_s - begin.sum_deg_s) / length_s, (end.turned_deg - begin.turned_deg) / length_s};
}

}  // namespace thermorig
