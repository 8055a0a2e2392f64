// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "gyro_search.h"
#include "heading_trust.h"
#include "innovations.h"
#include "mosaic.h"
#include "thermorig/core/surroundings/turn_path.h"
#include "tracker.h"

namespace thermorig::odometer {

/// Whether the gyro that a start has learnt is one that a data sheet knows: a map that closes falsely makes
/// it another, by 7 to 9 % of its scale, and by 6 % where things move.
inline bool is_plausible(const HeadingFilter& learnt, const Priors& priors, bool things_move) {
  constexpr double data_sheet_scale_sigma = 0.03;  // at least, whatever a profile says
  const double most = (things_move ? 1.8 : 2.2) * std::max(data_sheet_scale_sigma, priors.scale_sigma);
  return std::abs(learnt.scale_factor() - priors.scale) < most;
}

/// What a pass has learnt differs by less than so much from what it began with: another one would learn the
/// same.
struct Nearness {
  double bias_dps, scale, latency_s;
};
inline bool is_near(const HeadingFilter& learnt, const Priors& begun_with, const Nearness& limits) {
  return std::abs(learnt.bias_dps() - begun_with.bias_dps) < limits.bias_dps &&
         std::abs(learnt.scale_factor() - begun_with.scale) < limits.scale &&
         std::abs(learnt.latency_s() - begun_with.latency_s) < limits.latency_s;
}

/// A scale that no data sheet knows is believed when a second start, of other halves, has learnt the same:
/// maps that close falsely do so each in its own way.
class RefusedScale {
 public:
  RefusedScale() = default;

  /// Of a start that came to an end at `now_s`.
  void refuse(double scale, double now_s) {
    if (!is_same(scale)) *this = {scale, now_s};
  }
  /// By a start whose halves came from `first_s` on.
  bool is_confirmed(double scale, double first_s) const { return is_same(scale) && first_s > until_s_; }

 private:
  static constexpr double same = 0.004;
  RefusedScale(double scale, double until_s) : scale_(scale), until_s_(until_s) {}
  bool is_same(double scale) const { return std::abs(scale - scale_) < same; }

  double scale_ = 0.0, until_s_ = 0.0;  // 0: none
};

/// Where a start has not learnt one, rows are exposed in another order than the one that is tried.
inline bool has_usual_latency(const HeadingFilter& learnt, const Priors& priors) {
  constexpr double most_sigmas = 2.5;
  return std::abs(learnt.latency_s() - priors.latency_s) < most_sigmas * priors.latency_sigma_s;
}

/// The first half minute, moving or not: of its halves the gyro is found, and in which order the camera
/// exposes its rows; then a map is made of them, pass after pass, until a pass ends with what it began with.
/// Each half is a step of bounded work.
class Start {
 public:
  /// `front`: the tracker whose estimate is reported, and that tracks afterwards; `path`: the gyro's, up to
  /// each half.
  Start(const Priors& priors, const SharedLens& lens, bool latency_measured, Tracker& front,
        const TurnPath& path);

  /// Nothing of what came before is needed but `before`: the heading at which the map begins.
  void begin(const std::optional<GyroHeading>& before);
  /// Times have no meaning any more either.
  void forget();

  enum class Outcome : std::uint8_t {
    goes_on,
    over,   // the front tracker knows gyro and map, and has seen all halves that were kept
    failed  // it begins anew: nothing that it has seen fits together
  };
  Outcome add(const HalfFrame& half, double now_s);

  /// Instead of all that, for a map that was made before: what some seconds of halves tell of the gyro.
  std::optional<Priors> find_gyro(const HalfFrame& half, double now_s);

  /// The front tracker has gone through all halves that came.
  bool has_caught_up() const { return phase_ == Phase::learning || phase_ == Phase::second_pass; }
  /// For how long the heading has been the gyro's alone, at the end of a start that outlasted the minute that
  /// it keeps.
  double by_gyro_s(double now_s) const {
    return phase_ == Phase::learning ? 0.0 : now_s - store_.at(store_.count() - 1).now_s;
  }
  /// One standard deviation of where the map begins in the one before; 0 if there was none.
  double origin_sigma_deg() const;
  /// Something beside the rig: a start has shown it, or failed, or halves after it have.
  bool things_move() const { return things_move_; }
  /// Halves after the start have shown it.
  void expect_traffic();
  /// 0: the order in which rows are exposed was not found.
  double row_margin() const { return gyro_search_.rows().margin; }
  double mean_nis() const { return mean_nis_; }

 private:
  enum class Phase : std::uint8_t { searching, first_pass, learning, second_pass };

  void begin_searching();
  void store(const HalfFrame& half, double now_s);
  const NisBounds& bounds() const { return nis_bounds(things_move_); }
  void learn_fit(const HalfResult& result, double& mean) const { learn_nis(result, mean, bounds().most); }
  bool has_halves_enough(double now_s) const;
  std::size_t rests_since() const;
  void forget_early_halves();
  void forget_rest();
  /// Where the map begins: the heading of before, as the gyro has it with what is known of its bias by now.
  double heading_at(double time_s, double bias_dps) const {
    return before_ ? before_->deg(path_.until(time_s), bias_dps) : 0.0;
  }

  // Passes through the halves.
  bool is_due_to_begin() const;
  void begin_first_pass(const Priors& found);
  void begin_pass(int number);
  void restart_pass(int number);
  void go_through(Tracker& tracker);

  // What becomes of it.
  Outcome go_on_learning(double now_s);
  Outcome take_over(double now_s);
  Outcome learn_again();
  Outcome fail();
  Outcome begin_anew();
  bool has_repeated() const;
  bool has_settled() const;
  bool knows_scale() const;
  bool is_plausible() const { return odometer::is_plausible(front_.filter(), priors_, things_move_); }
  bool does_search_agree() const;
  bool shows_traffic() const;
  bool knows_rows() const { return lens_->knows_rows() || row_margin() > 0.0; }

  Priors priors_;
  SharedLens lens_;
  Tracker& front_;
  const TurnPath& path_;
  Tracker back_;  // goes through the halves again
  HalfStore store_;
  double rested_s_ = 0.0;  // since its first half: what was forgotten
  std::optional<GyroHeading> before_;
  bool things_move_ = false;

  GyroSearch gyro_search_;
  std::optional<Priors> searched_;  // by which it began
  bool is_of_later_half_ = false;   // what it goes through

  Phase phase_ = Phase::searching;
  int pass_ = 0;                  // 0: the first one, then its repeats
  Priors begun_with_;             // of the pass
  std::size_t gone_through_ = 0;  // halves of the store
  InnovationCount innovations_;
  RefusedScale refused_scale_;
  double pass_nis_ = 1.0, mean_nis_ = 1.0;  // of the tracker that goes through them, and of the front one
};

}  // namespace thermorig::odometer
