// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/pipeline/timing/ping_bounds.h"

namespace thermorig::timing {

/// The micro-controller's clock from both sides: every clock that obeys all bounds and whose rate, within any
/// minute, stays within its wander of its mean over that minute. The mean itself is not assumed (only that it
/// is within 2 % of nominal): the bounds a minute apart bound it. The wander is PortProfile::wander_ppm;
/// where that does not explain what was heard it grows, up to 0.2 %, to twice what does. So earlier_s and
/// later_s of an estimate hold for a ceramic resonator that warms up, and while the host's clock is slewed.
/// The last minute ends now, so that its mean is not the rate now: they have room for a clock that goes on as
/// it drifts and bows as far as they would not show. The time itself is the middle of bounds without that
/// room.
///
/// An empty set is then a reset, a wrong baud rate, a clock that jumped or a suspended host: it is reported
/// and starts a new epoch, once three messages in a row agree on it; single messages that fit no clock are
/// left out. Causal. O(1) a message, but for a walk over the last minute once a second, and some more where
/// the wander grows; bounded memory.
class PingClock {
 public:
  explicit PingClock(const PortProfile& link);

  /// Bounds come in the order in which their messages did. An answer that was sent before its ping is
  /// ignored.
  void feed(const PingBound& bound);

  /// When the micro-controller's clock showed `mcu_us` (unwrapped, of the newest epoch). None before the
  /// epoch's first exchange.
  std::optional<TimeEstimate> at(std::int64_t mcu_us) const;

  /// Epochs so far, the first included.
  const std::vector<ClockEpoch>& epochs() const { return epochs_; }

  /// Which bound, counted from 0 in the order of feed(), was the first of each epoch.
  const std::vector<std::size_t>& first_bounds() const { return first_bounds_; }

  /// Whether the bound that was fed last is one of the clock's, or in doubt.
  bool doubted() const { return doubted_; }

 private:
  struct Rival {
    PingBounds bounds;
    PingFate fate;
    std::size_t first;
    HostTime begin;
    std::string reason;
    std::vector<PingBound> taken;
  };
  bool wanders_more(const PingBound& bound, PingFate fate);
  std::optional<PingBounds> followed(const PingBound& bound, double wander) const;
  void follow_surely();
  void remember(const PingBound& bound);
  void doubt(const PingBound& bound, PingFate fate);
  void trust(const PingBound& bound);
  void begin_epoch(Rival&& rival);
  void impossible(PingBound bound);
  std::string reason(const PingBound& bound, PingFate fate) const;

  PortProfile link_;
  double wander_;
  std::size_t fed_ = 0;
  std::optional<PingBounds> current_;  // that are likely
  std::optional<PingBounds> sure_;     // of the same bounds, with room for what they may hide
  std::deque<PingBound> recent_;       // of the clock so far: the last minute
  int failed_searches_ = 0;            // for a wander that explains a bound, in this epoch
  std::optional<Rival> rival_;
  int impossible_ = 0;  // in a row
  bool doubted_ = false;
  std::vector<ClockEpoch> epochs_;
  std::vector<std::size_t> first_bounds_;
};

/// Why bounds contradict each other by so little that no reset and no suspension explains it.
std::string contradiction_reason(double missed_s, const PortProfile& link);

/// "5.2 s", "0.31 ms": a duration as a person reads it.
std::string duration_text(double seconds);

}  // namespace thermorig::timing
