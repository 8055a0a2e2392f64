// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "thermorig/pipeline/timing/ping_bounds.h"

namespace thermorig::fit {

using namespace timing;

/// The tightest bounds that a whole epoch gives: each bound reaches to both sides, as far as the rate allows,
/// and the rate is bounded by the bounds a window apart. Passes forward and back, linear in the events, until
/// the rate is bounded no better.
class PingHull {
 public:
  struct Event {
    double mcu_s = 0.0;
    Range given;  // bounds of the offset there; infinite where an event only asks
  };
  struct Break {
    std::size_t event = 0;  // the first one that no clock explains together with those before
    double missed_s = 0.0;  // by so much
  };

  /// Events in ascending order of their time, which outlive the hull. `unseen_s`: so far the offset may bow
  /// within a minute unseen by the bounds. It counts where the minute lies to one side, at an end of a
  /// clock's life: there the rate also may go on as it drifts. 0: neither counts.
  PingHull(std::span<const Event> events, double wander, double unseen_s = 0.0);

  std::span<const Event> events() const { return events_; }
  const std::vector<Range>& offsets() const { return offsets_; }  // at each event
  /// Whether one clock of that wander explains all events.
  bool explains_all() const { return breaks_.empty() && rates_agree_; }

  const std::vector<Break>& breaks() const { return breaks_; }      // ascending
  const std::vector<std::size_t>& knots() const { return knots_; }  // events, about one in two seconds

  /// Mean rate over the window around a knot, middle of its bounds.
  double rate_at(std::size_t knot) const;

 private:
  /// Around a segment: at an end of a clock's life it lies to one side.
  struct Window {
    double middle_s = 0.0;
    double span_s = 0.0;
    Range mean;  // rate over it
  };
  void place_knots();
  void bound_rates();
  Range mean_rate(std::size_t first, std::size_t last) const;
  Range window(std::size_t segment) const;
  void place_windows();
  double middle_s(std::size_t first, std::size_t last) const;
  double drift(std::size_t segment, std::ptrdiff_t step) const;
  Range allowed(std::size_t segment) const;
  void forward();
  void backward();
  bool begins(std::size_t event) const { return begins_[event] != 0; }
  void split(std::size_t event, double missed_s);

  double wander_;
  double unseen_s_;
  std::span<const Event> events_;
  std::vector<Range> offsets_;
  std::vector<char> begins_;  // events at which the clock starts anew
  std::vector<Break> breaks_;
  std::vector<std::size_t> knots_;
  bool rates_agree_ = true;                     // the mean over each window with those around it
  std::vector<std::optional<Window>> windows_;  // by segment
  std::vector<Range> rates_;                    // allowed from knot k to knot k + 1
};

}  // namespace thermorig::fit
