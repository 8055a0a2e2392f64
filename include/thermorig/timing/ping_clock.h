// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/core/sync.h"
#include "thermorig/core/time.h"

namespace thermorig::timing {

/// One answered ping: bounds from both sides. Wire times are taken off already.
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

/// The micro-controller's clock from both sides: every clock of that rate (within PortProfile::wander_ppm of
/// its mean) that obeys all bounds. Its width is a proof. An empty set is a reset, a wrong baud or a
/// suspended host: it is reported and starts a new epoch. Causal: what it says uses the past alone.
class PingClock {
 public:
  explicit PingClock(const PortProfile& link);

  void exchange(const PingExchange& exchange);
  void sent(const SentStamp& stamp);

  /// When the micro-controller's clock showed `mcu_us` (unwrapped, of the newest epoch). None before the
  /// first exchange.
  std::optional<TimeEstimate> at(std::int64_t mcu_us) const;

  /// Epochs so far, the first included.
  const std::vector<ClockEpoch>& epochs() const;
};

/// The same over a whole recording, non-causal: the times of `mcu_us`, and a report with knots.
struct PingFit {
  std::vector<TimeEstimate> times;
  ClockReport report;
};
PingFit fit_pings(std::span<const std::int64_t> mcu_us, std::span<const PingExchange> exchanges,
                  std::span<const SentStamp> sent, const PortProfile& link);

}  // namespace thermorig::timing
