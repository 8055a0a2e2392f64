// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/core/sample.h"
#include "thermorig/pipeline/final_times.h"
#include "thermorig/pipeline/ping_ledger.h"
#include "thermorig/pipeline/pipeline.h"
#include "thermorig/pipeline/timing/device_time.h"
#include "thermorig/pipeline/timing/link_timing.h"
#include "thermorig/pipeline/timing/ping_clock.h"
#include "thermorig/pipeline/timing/read_ledger.h"
#include "thermorig/sensors/servo_protocol.h"

namespace thermorig::pipeline {

/// Counts the turns of a shaft whose sensor knows the angle within one turn, and takes off what the profile
/// knows of that sensor.
class ShaftTurns {
 public:
  explicit ShaftTurns(const EncoderProfile& encoder) : encoder_(encoder) {}

  /// Half a turn takes longer at any speed that a rig can have; what passed in a longer silence is not known.
  static constexpr std::int64_t longest_silence_us = 300'000;

  /// Fills in its angle, and whether turns are counted anew from here on.
  void count(bool lost_before, TimedShaft& shaft) {
    const ShaftReading& reading = shaft.reading;
    if (!has_angle(reading) || !std::isfinite(reading.angle_deg)) return;
    const double turn_deg = reading.turn_deg;
    const bool silent = last_ && !(shaft.mcu_time_us >= last_->mcu_time_us &&
                                   shaft.mcu_time_us - last_->mcu_time_us <= longest_silence_us);
    shaft.lost_before = !last_ || silent || (lost_before && turn_deg == 0.0);
    double sent_deg = reading.angle_deg;
    if (!shaft.lost_before && turn_deg > 0.0)
      sent_deg += turn_deg * std::round((last_->sent_deg - sent_deg) / turn_deg);
    shaft.angle_deg = encoder_.angle_deg(sent_deg);
    last_ = Last{shaft.mcu_time_us, sent_deg};
  }

  /// The device was away.
  void restart() { last_.reset(); }

 private:
  struct Last {
    std::int64_t mcu_time_us;
    double sent_deg;  // turns counted
  };
  EncoderProfile encoder_;
  std::optional<Last> last_;
};

/// Servo bytes to telemetry with its time, pongs, and the answers that the rig's servo link waits for.
class ServoDecoder {
 public:
  ServoDecoder(const ServoProfile& profile, const EncoderProfile& encoder, const Fits& fits);

  /// Bytes to the servo: pings among them bound its clock, once they are answered; and some servos' answers
  /// are only understood with them.
  void sent(std::span<const std::uint8_t> bytes, HostTime before_write);

  /// What a chunk brought.
  struct Decoded {
    std::span<const TimedServo> servo;
    std::span<const TimedShaft> shaft;
  };

  /// Appends what the chunk completes to `out` and returns its telemetry and readings of the shaft.
  Decoded push(std::span<const std::uint8_t> chunk, HostTime arrived, Streams& out);

  /// The stream has ended: the telemetry that waited for the bytes behind it.
  Decoded finish(Streams& out);

  /// The servo is away: what it sends from here on is another stream of a clock anew.
  void interrupt(Streams& out);

  const wire::Counters& counters() const { return scanner_.counters(); }

 private:
  Decoded take(Streams& out);
  void sort(wire::ServoMessage&& message, Streams& out);
  TimedServo timed(const wire::ServoMessage& message, const ServoState& state);
  TimedPong timed(const wire::ServoMessage& message, const wire::ServoPong& pong);
  TimedShaft timed(const wire::ServoMessage& message, const ShaftReading& reading);
  void stamp_by_clock(TimedServo& servo, HostTime not_after);
  void learn_of_answer(const TimedServo& servo, HostTime asked, HostTime not_after);
  void learn(const TimedPong& pong, HostTime not_after);
  HostTime begun_by(const StreamSpan& span) const;

  PortProfile link_;
  sensors::ServoScanner scanner_;
  timing::LinkTiming timing_;
  FinalTimes final_times_;
  std::uint32_t baud_;
  HostTime newest_arrival_{HostTime::min()};
  bool sends_time_;  // else its time is that of arrivals, or of requests, which wait for no timer
  std::vector<std::uint8_t> telemetry_request_;  // empty: there is none
  timing::ReadLedger reads_;                     // when the last byte of each was through
  ClockProperties mcu_clock_;
  timing::McuTime mcu_time_;
  PingLedger pings_;
  timing::PingClock clock_;
  bool is_causal_;                       // without final times: the clock is learnt on the way
  std::size_t epochs_passed_on_ = 1;     // the first is no event
  std::optional<TimedServo> telemetry_;  // the newest
  bool is_placed_ = true;                // its time is known well enough to place a reading of the shaft
  double rate_scale_ = 1.0;              // of the speeds that it states
  double host_s_per_us_ = 1e-6;          // of the servo's clock, by the newest two
  HostDuration encoder_latency_;
  ShaftTurns turns_;
  bool was_away_ = false;                     // since then
  std::vector<wire::ServoMessage> messages_;  // empty between calls; kept for its memory
};

}  // namespace thermorig::pipeline
