// SPDX-License-Identifier: MIT
#include "observer.h"

#include <limits>

namespace thermorig::estimators {

namespace {

constexpr HostDuration longest_silence = std::chrono::milliseconds(500);  // of telemetry: 100 a second

/// The same frame without what was seen: times and gaps.
void blank_into(const TimedFrame& frame, TimedFrame& blank) {
  blank = frame;
  blank.frame.temp_c.fill(std::numeric_limits<float>::quiet_NaN());
  blank.frame.sensor_temp_c = std::numeric_limits<float>::quiet_NaN();
  blank.fresh_even = blank.fresh_odd = 0;
}

}  // namespace

void ServoOrder::add(std::span<const TimedServo> states, HostTime now) {
  for (const TimedServo& state : states) add(state);
  if (last_ && now - *last_ > longest_silence) *this = ServoOrder();
}

void ServoOrder::add(const TimedServo& state) {
  const HostTime time = state.stamp.time;
  const bool is_anew = state.lost_before || !last_ || time < *last_ || time - *last_ > longest_silence;
  if (!is_at_rest(state.state))
    still_since_.reset();
  else if (!still_since_ || is_anew)
    still_since_ = time;
  last_ = time;
}

void Observer::take(const Measurement& measurement) {
  measurement_ = &measurement;
  order_.add(measurement.servo, measurement.frame.exposure_end);
  blank_into(measurement.frame, blank_);
  ++count_;
}

Observation Observer::seen_with(const Inputs& inputs) const {
  return {.index = count_ - 1,
          .frame = inputs.image ? measurement_->frame : blank_,
          .gyro_mean_dps = inputs.gyro ? measurement_->sample.rate_gyro_dps : RateEstimate::not_known,
          .gyro = inputs.gyro ? std::span<const TimedGyro>(measurement_->gyro) : std::span<const TimedGyro>(),
          .still_since = inputs.rest ? order_.still_since() : std::nullopt,
          .is_told_to_move = inputs.rest && order_.is_to_move()};
}

}  // namespace thermorig::estimators
