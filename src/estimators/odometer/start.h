// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "gyro_heading.h"
#include "gyro_search.h"
#include "half_store.h"
#include "innovation_count.h"
#include "plausibility.h"
#include "thermorig/core/surroundings/turn_path.h"
#include "tracker.h"

namespace thermorig::odometer {

/// The first half minute, moving or not: of its halves the gyro is found, and in which order the camera
/// exposes its rows; then a map is made of them, pass after pass, until a pass ends with what it began with.
/// Each half is a step of bounded work.
class Start {
 public:
  /// `front`: the tracker that is told of, and that tracks afterwards; `path`: the gyro's, up to each half.
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
  /// For how long the gyro alone has told the heading, at the end of a start that outlasted the minute that
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
  /// 0: the images have not told in which order rows are exposed.
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
  bool is_scale_named() const;
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
