// SPDX-License-Identifier: MIT
#include "observer.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
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

bool is_sound(const TimedGyro& sample) {
  const auto& axes = sample.reading.rate_dps;
  return std::isfinite(sample.rate_dps) && std::isfinite(sample.stamp.uncertainty_s) &&
         std::all_of(axes.begin(), axes.end(), [](float rate_dps) { return std::isfinite(rate_dps); });
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
  take_gyro(measurement.gyro);
  take_frame(measurement.frame);
  ++count_;
}

void Observer::take_gyro(std::span<const TimedGyro> gyro) {
  gyro_ = gyro;
  const auto unsound =
      static_cast<std::size_t>(std::count_if(gyro.begin(), gyro.end(), std::not_fn(is_sound)));
  if (unsound == 0) return;
  ignored_ += unsound;
  sound_gyro_.clear();
  std::copy_if(gyro.begin(), gyro.end(), std::back_inserter(sound_gyro_), is_sound);
  gyro_ = sound_gyro_;
}

void Observer::take_frame(const TimedFrame& frame) {
  seen_ = &frame;
  if (!std::isfinite(frame.stamp.uncertainty_s)) {
    ++ignored_;
    blank_.stamp.uncertainty_s = 0.0F;
    seen_ = &blank_;
    return;
  }
  pixels_.add(frame);
  if (pixels_.bad().empty()) return;
  mended_ = frame;
  mend(mended_.frame, pixels_.bad());
  seen_ = &mended_;
}

Observation Observer::seen_with(const Inputs& inputs) const {
  return {.index = count_ - 1,
          .frame = inputs.image ? *seen_ : blank_,
          .gyro_mean_dps = inputs.gyro ? measurement_->sample.rate_gyro_dps : RateEstimate::not_known,
          .gyro = inputs.gyro ? gyro_ : std::span<const TimedGyro>(),
          .still_since = inputs.rest ? order_.still_since() : std::nullopt,
          .is_told_to_move = inputs.rest && order_.is_to_move()};
}

}  // namespace thermorig::estimators
