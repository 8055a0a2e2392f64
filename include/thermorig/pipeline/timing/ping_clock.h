// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/core/sync.h"
#include "thermorig/core/time.h"

namespace thermorig::timing {

/// One answered ping: bounds from both sides. Wire times are taken off already, as short as they can be.
struct PingExchange {
  std::int64_t receive_us = 0;  // micro-controller, unwrapped: the ping's last byte was in
  HostTime not_before{};  // receive_us is not before it: host time before write(), plus the ping's wire time
  std::int64_t send_us = 0;  // the answer's first byte was handed to the transmitter
  HostTime not_after{};      // send_us is not after it: the answer's arrival minus its wire time
};

/// One message whose sending time the micro-controller stamped (telemetry): a bound from above alone.
struct SentStamp {
  std::int64_t send_us = 0;
  HostTime not_after{};
};

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
/// left out. Causal: what it says uses the past alone. O(1) a message, but for a walk over the last minute
/// once a second, and some more where the wander grows; bounded memory.
class PingClock {
 public:
  explicit PingClock(const PortProfile& link);
  ~PingClock();
  PingClock(PingClock&&) noexcept;
  PingClock& operator=(PingClock&&) noexcept;

  /// In order of arrival, mixed with sent(). An exchange whose answer was sent before its ping is ignored.
  void exchange(const PingExchange& exchange);
  void sent(const SentStamp& stamp);

  /// When the micro-controller's clock showed `mcu_us` (unwrapped, of the newest epoch). None before the
  /// epoch's first exchange.
  std::optional<TimeEstimate> at(std::int64_t mcu_us) const;

  /// Epochs so far, the first included.
  const std::vector<ClockEpoch>& epochs() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace thermorig::timing
