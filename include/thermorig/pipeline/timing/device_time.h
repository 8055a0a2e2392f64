// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "thermorig/core/clock_properties.h"
#include "thermorig/core/time.h"

namespace thermorig::timing {

/// Unwraps the servo's 32-bit microseconds, which start again after 71.6 minutes as its clock says, to 64
/// bits.
///
/// The host's clock says how many times they wrapped since the telemetry before, and whether the
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

/// Counts how often the time that a device sends began again: 32 bits of microseconds (an Arduino's micros())
/// do after 71.6 minutes, of tenths of milliseconds (Xsens) after 119 hours, of milliseconds (millis(),
/// MAVLink's time_boot_ms) after 49.7 days. The host's clock tells a wrap from a reset: a step back that is
/// neither stays one.
class UnwrappedTime {
 public:
  /// In seconds. `arrived`: when its message did.
  double unwrap_s(std::int64_t device_us, HostTime arrived);

 private:
  struct Seen {
    std::int64_t device_us;
    HostTime arrived;
  };
  std::optional<Seen> last_;
  double wrapped_s_ = 0.0;
};

/// The time that came with a message, in s by the device's clock, and when the message arrived.
struct OwnStamp {
  double own_s = 0.0;
  HostTime arrived{};
};

/// Why the times are not those at which samples of a steady device were taken, ready to print: many follow
/// the one before at once, though no more messages come than are due (samples out of a FIFO under one stamp,
/// or stamps of printing), or they do not go as fast as the host's clock. Empty: they may well be, or too few
/// came to say. `nominal_rate_hz`: messages a second that are due; `rate_error_max`: of the device's clock,
/// as a share.
std::string why_no_sample_times(std::span<const OwnStamp> times, double nominal_rate_hz,
                                double rate_error_max);

/// The same while messages come: their places on the device's clock, until its times prove to be none of
/// samples.
class OwnClock {
 public:
  OwnClock(double nominal_rate_hz, double rate_error_max)
      : nominal_rate_hz_(nominal_rate_hz), rate_error_max_(rate_error_max) {}

  /// In s; nothing if the message brought no time, or the times are not used.
  std::optional<double> place_s(const std::optional<std::int64_t>& device_us, HostTime arrived);

  bool is_unused() const { return is_unused_; }

  /// The device was away.
  void restart() { *this = OwnClock(nominal_rate_hz_, rate_error_max_); }

 private:
  static constexpr std::size_t kept = 512;      // more than a FIFO holds
  static constexpr std::size_t looked_at = 32;  // new ones, until they are judged again

  double nominal_rate_hz_;
  double rate_error_max_;
  UnwrappedTime unwrapped_;
  std::vector<OwnStamp> times_;
  std::size_t new_ = 0;
  bool is_unused_ = false;
};

}  // namespace thermorig::timing
