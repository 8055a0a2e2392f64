// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <span>

#include "thermorig/core/profile.h"
#include "thermorig/core/sync.h"
#include "thermorig/core/time.h"

namespace thermorig::timing {

/// One answered ping: bounds from both sides. Wire times are taken off already, as short as they can be. Or
/// one message whose sending time the micro-controller stamped (telemetry): a bound from above alone,
/// sent_at().
struct PingBound {
  std::int64_t receive_us = 0;  // micro-controller, unwrapped: the ping's last byte was in
  HostTime not_before{};  // receive_us is not before it: host time before write(), plus the ping's wire time
  std::int64_t send_us = 0;  // the answer's first byte was handed to the transmitter
  HostTime not_after{};      // send_us is not after it: the answer's arrival minus its wire time
  bool two_sided = true;     // else the first two are of no meaning
};

inline PingBound sent_at(std::int64_t send_us, HostTime not_after) {
  return {.send_us = send_us, .not_after = not_after, .two_sided = false};
}

// A clock is written as the offset d(m), host time minus micro-controller time in seconds, over
// micro-controller time m. What is assumed of it, and all that the bounds rest on:
//
//   its rate never is further than `max_rate` from nominal (an RC oscillator keeps within 2 %), and within
//   any stretch of at most `rate_window_s` it stays within its wander of its mean over the stretch.
//
// The mean itself is not assumed: bounds of d at both ends of a stretch bound it. Beyond the window the
// allowance grows in proportion to the stretch. The wander is PortProfile::wander_ppm, or more where what was
// heard needs more: a resonator that warms up, a host's clock that is slewed.

inline constexpr double max_rate = 0.02;
inline constexpr double rate_window_s = 60.0;

/// The largest wander that is believed of a clock: a host's clock is slewed by 500e-6 at most (adjtimex(2)),
/// one way and then none or the other; a ceramic resonator that warms up adds 300e-6. Beyond it a clock has
/// jumped, or is another one.
inline constexpr double largest_wander = 2000e-6;

/// No clock is better: finitely many doublings lead up from it to the largest.
inline constexpr double least_wander = 0.1e-6;

/// Stamps are read from a timer of so many microseconds: what is stamped m happened between m and m + tick.
inline constexpr std::int64_t stamp_tick_us = 4;

/// Messages of one stream are told apart from a reset by this: two that left in order may be handed over out
/// of order by less, and no reset of a micro-controller is over in so little time.
inline constexpr double order_tolerance_s = 0.2;

/// Rounding of stamps to a microsecond, and of offsets in seconds to a double.
inline constexpr double rounding_s = 2e-6;

inline constexpr double unbounded = std::numeric_limits<double>::infinity();

/// Bounds of an offset, or of its rate.
struct Range {
  double lo = -unbounded;
  double hi = unbounded;
  bool empty() const { return lo > hi; }
  double width() const { return hi - lo; }
  double middle() const { return (lo + hi) / 2; }
};

/// How far a clock may have run from the line of its mean rate after `span_s`.
double wander_reach_s(double span_s, double wander);

/// `later` - `before` in seconds, whatever hostile values they have.
double seconds_between(HostTime before, HostTime later);
double seconds_between(std::int64_t before_us, std::int64_t later_us);

/// Where offsets count from.
struct ClockOrigin {
  HostTime host{};
  std::int64_t mcu_us = 0;
  double mcu_s(std::int64_t at_us) const { return seconds_between(mcu_us, at_us); }
  double offset_s(std::int64_t at_us, HostTime time) const {
    return seconds_between(host, time) - mcu_s(at_us);
  }
  HostTime time(double mcu_at_s, double offset_s) const;
  TimeEstimate estimate(double mcu_at_s, const Range& offset) const;
};

/// What a mean rate over a minute or less says of the rate `aside_s` from the middle of that time. A clock
/// may go on as its mean drifts (`drift`, per second), and bow unseen: an offset that bows by s within a time
/// T has a rate that is off by 8 s / T^2 times the distance from the middle.
Range rate_aside(const Range& mean, double aside_s, double drift, double unseen_s);

/// Median width of those offsets that are bounded from both sides; 0 where none is.
double median_width_s(std::span<const Range> offsets);

/// What a bound says of the offset: of its ping's arrival, and of its answer's sending.
Range lower_bound(const PingBound& bound, const ClockOrigin& origin);
Range upper_bound(const PingBound& bound, const ClockOrigin& origin);

/// PortProfile::wander_ppm as a share, whatever was configured.
double wander_of(const PortProfile& link);

/// The likely time, within the bounds that are sure.
TimeEstimate within(TimeEstimate likely, const TimeEstimate& sure);

/// How a bound stands to a clock.
enum class PingFate : std::uint8_t {
  fits,
  went_back,        // the micro-controller's time ran backwards
  too_early,        // the message arrived before any clock allows
  too_late,         // the ping came in later than any clock allows
  faster_than_wire  // no clock at all allows it
};

/// What a mean rate over the last minute says of now, at the end of that minute.
enum class RateNow : std::uint8_t {
  is_the_mean,  // within the wander: most likely
  may_differ,   // rate_aside(): surely
};

/// Causal bounds of one epoch's clock: O(1) a bound and, once a second, a walk over the last minute.
class PingBounds {
 public:
  PingBounds(const PingBound& first, double wander, RateNow rate_now = RateNow::is_the_mean);

  PingFate fate(const PingBound& bound) const;
  void take(const PingBound& bound);

  bool two_sided() const { return two_sided_; }
  Range at(double mcu_s) const;
  Range at(std::int64_t mcu_us) const { return at(origin_.mcu_s(mcu_us)); }
  const ClockOrigin& origin() const { return origin_; }
  std::int64_t newest_us() const { return newest_us_; }

  /// By how much a bound misses the clock, in seconds.
  double missed_by_s(const PingBound& bound) const;

 private:
  struct Knot {
    double mcu_s = 0.0;
    Range offset;
  };
  Range onward(const Knot& from, double mcu_s) const;
  Range backward(const Knot& from, double mcu_s) const;
  void constrain(double mcu_s, const Range& offset);
  void set_knot();
  void refine_knots();
  void bound_rate();
  double width_s() const;
  double drift() const;

  double wander_;
  RateNow rate_now_;
  ClockOrigin origin_;
  std::int64_t newest_us_ = 0;
  Knot newest_;
  std::deque<Knot> knots_;           // about one a second, the last `rate_window_s`
  Range rate_{-max_rate, max_rate};  // mean over that window
  bool two_sided_ = false;
};

}  // namespace thermorig::timing
