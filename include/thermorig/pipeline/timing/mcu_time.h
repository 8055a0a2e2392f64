// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>

#include "thermorig/core/clock_properties.h"
#include "thermorig/core/time.h"

namespace thermorig::timing {

/// Unwraps the servo's 32-bit microseconds, which start again after 71.6 minutes as its clock says, to 64
/// bits.
///
/// The host's clock tells how many times they wrapped since the telemetry before, and whether the
/// micro-controller was reset: where no number of wraps explains the host time that passed to within
/// `tolerance_s` plus what the clock may be off by, a new epoch begins with the value as it was sent. So a
/// step back in unwrapped time is always a reset. After an absence, during which it may have been reset
/// unseen, the time jumps ahead by more than a wrap, so that nobody takes what lies between for a short
/// pause.
class McuTime {
 public:
  static constexpr double tolerance_s = 1.0;  // above any delay of a USB link, below any reset and start

  /// `clock` wraps, after at most 2^32 us.
  explicit McuTime(const ClockProperties& clock);

  /// Microseconds since the micro-controller's reset. `at` is when the message was sent, as well as known.
  std::int64_t unwrap(std::uint32_t mcu_us, HostTime at);

  /// The device was away.
  void restart();

 private:
  struct Seen {
    std::uint32_t mcu_us;
    std::int64_t unwrapped_us;
    HostTime at;
  };
  std::optional<std::int64_t> advance_us(std::uint32_t before, std::uint32_t now, double host_us) const;

  std::int64_t wrap_us_;
  double rate_error_max_;
  std::optional<Seen> last_;
  std::int64_t restarted_us_ = 0;  // where time begins since the last absence
};

}  // namespace thermorig::timing
