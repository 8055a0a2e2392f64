// SPDX-License-Identifier: MIT
#include "row_contest.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace thermorig::odometer {

namespace {

constexpr std::size_t compared_halves = 24;
constexpr double contest_trust = 0.05;  // of its likelihood: halves share the errors of one map
constexpr double fitting_nis = 4.0;     // of one that may win
constexpr std::array all_orders{RowOrder::at_once, RowOrder::first_to_last, RowOrder::last_to_first};
constexpr float not_judged = std::numeric_limits<float>::quiet_NaN();

}  // namespace

RowContest::RowContest(const Priors& priors, const SharedLens& lens, bool latency_measured)
    : priors_(priors),
      latency_measured_(latency_measured),
      rivals_{Rival(RowOrder::first_to_last, priors, lens), Rival(RowOrder::last_to_first, priors, lens)} {
  for (auto& one : left_k2_) one.assign(HalfStore::room, not_judged);
}

void RowContest::begin() {
  is_gyro_known_ = false;
  of_caller_ = RowOrder::at_once;
  rivals_[0].order = RowOrder::first_to_last;
  rivals_[1].order = RowOrder::last_to_first;
  for (Rival& rival : rivals_) {
    rival.has_begun = rival.is_out = false;
    rival.passes = 0;
  }
  for (auto& one : left_k2_) std::fill(one.begin(), one.end(), not_judged);
}

void RowContest::begin_again(RowOrder of_caller, const Priors& known, const HalfStore& store,
                             bool is_scale_known) {
  is_gyro_known_ = is_scale_known;
  of_caller_ = of_caller;
  Priors better = known;
  better.latency_s = priors_.latency_s;  // what the caller learnt of it makes up for the order of rows
  better.latency_sigma_s = priors_.latency_sigma_s;
  std::size_t next = 0;
  for (const RowOrder order : all_orders) {
    if (order == of_caller) continue;
    Rival& rival = rivals_[next++];
    rival.order = order;
    rival.is_out = false;
    std::fill(left_of(order).begin(), left_of(order).end(), not_judged);
    begin(rival, better, store);
  }
}

bool RowContest::are_heard(const HalfStore& store) const {
  return std::all_of(rivals_.begin(), rivals_.end(),
                     [&](const Rival& rival) { return rival.is_out || rival.gone_through == store.count(); });
}

bool RowContest::may_end(const HalfStore& store, bool must_hear) const {
  if (!is_gyro_known_ || are_heard(store)) return true;
  return !must_hear && verdict().order == of_caller_;
}

int RowContest::add(const HalfStore& store, const GyroPath& path, int work_of_one) {
  // One that searches for its heading takes the other one's time: they begin in turn.
  int work = 0;
  for (const std::size_t i : {store.count() % 2, (store.count() + 1) % 2})
    if (rivals_[i].has_begun && work <= 2 * work_of_one)
      work += go_through(rivals_[i], store, path, work_of_one);
  return work;
}

void RowContest::begin(Rival& rival, const Priors& better, const HalfStore& store) {
  const HalfReading& half = store.at(0).half;
  const double period_s = half.end_s - half.begin_s;
  rival.by_middle_row = better;
  rival.by_last_row = better;
  rival.by_last_row.latency_s += 0.5 * period_s;
  rival.has_begun = true;
  rival.passes = 0;
  begin_pass(rival);
}

/// Where a pass was lost, another one begins with what it learnt; then it may be wrong which rows the
/// camera's times are those of.
void RowContest::begin_pass(Rival& rival) {
  const int passes = passes_in_turn();
  const bool is_last_row = may_be_last_row(rival) && rival.passes < passes;
  const Priors& first = is_last_row ? rival.by_last_row : rival.by_middle_row;
  const bool is_again = rival.passes % passes != 0;
  rival.tracker.restart(is_again ? rival.tracker.learnt(priors_) : first, rival.order);
  rival.gone_through = 0;
  rival.nis = 1.0;
  ++rival.passes;
}

int RowContest::go_through(Rival& rival, const HalfStore& store, const GyroPath& path, int most) {
  int work = 0;
  for (; work < most && rival.gone_through < store.count(); ++rival.gone_through) {
    const auto& [half, came_s] = store.at(rival.gone_through);
    if (!rival.tracker.has_begun() || came_s > rival.tracker.now_s()) rival.tracker.advance(path, came_s);
    const HalfResult result = rival.tracker.add(half, path);
    work += result.work;
    learn_nis(result, rival.nis);
    note(rival.order, rival.gone_through, result);
  }
  if (rival.nis <= lost_nis) return work;
  const int passes = (may_be_last_row(rival) ? 2 : 1) * passes_in_turn();
  rival.passes < passes ? begin_pass(rival) : give_up(rival);
  return work;
}

/// It waits for another gyro, if that may be wrong.
void RowContest::give_up(Rival& rival) {
  rival.has_begun = false;
  rival.is_out = is_gyro_known_;
}

void RowContest::note(RowOrder order, std::size_t place, const HalfResult& result) {
  if (place < HalfStore::room)
    left_of(order)[place] = result.is_judged ? static_cast<float>(result.left_k2) : not_judged;
}

/// Pixels' differences from the map as normal ones of unknown variance, over the halves that both judged.
std::optional<double> RowContest::lead(RowOrder order, RowOrder other) const {
  const auto &own = left_of(order), &others = left_of(other);
  double count = 0.0, sum = 0.0, sum_of_other = 0.0;
  for (std::size_t i = 0; i < HalfStore::room; ++i) {
    if (std::isnan(own[i]) || std::isnan(others[i])) continue;
    count += 1.0;
    sum += double{own[i]};
    sum_of_other += double{others[i]};
  }
  if (count < double{compared_halves} || !(sum > 0.0) || !(sum_of_other > 0.0)) return std::nullopt;
  return contest_trust * 0.5 * double{half_pixels} * count * std::log(sum_of_other / sum);
}

/// Its least lead; nothing: it could not be compared. One that was given up may have led over the few halves
/// before that, and is not heard against another than the caller's.
std::optional<double> RowContest::margin_of(RowOrder order) const {
  std::optional<double> margin;
  for (const RowOrder other : all_orders) {
    if (other == order || (order != of_caller_ && is_out(other))) continue;
    const auto one = lead(order, other);
    if (one && (!margin || *one < *margin)) margin = one;
  }
  return margin;
}

FoundRows RowContest::verdict() const {
  FoundRows best;
  for (const RowOrder order : all_orders) {
    const auto margin = is_out(order) ? std::nullopt : margin_of(order);
    if (margin && *margin > best.margin) best = {order, *margin};
  }
  const bool does_not_fit = best.order != of_caller_ && rival(best.order).nis > fitting_nis;
  if (best.margin < FoundRows::least_margin || does_not_fit) best.order = of_caller_;
  return best;
}

bool RowContest::another_may_fit() const {
  const bool goes_on =
      std::any_of(rivals_.begin(), rivals_.end(), [](const Rival& rival) { return !rival.is_out; });
  return verdict().order != of_caller_ || (is_gyro_known_ && goes_on);
}

double RowContest::swap(RowOrder winner, Tracker& of_caller) {
  Rival& swapped = rival(winner);
  std::swap(of_caller, swapped.tracker);
  std::swap(of_caller_, swapped.order);
  return swapped.nis;
}

}  // namespace thermorig::odometer
