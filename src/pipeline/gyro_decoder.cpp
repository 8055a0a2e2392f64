// SPDX-License-Identifier: MIT
#include "gyro_decoder.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "thermorig/core/statistics.h"

namespace thermorig::pipeline {

namespace {
constexpr HostDuration settling = std::chrono::seconds(2);
constexpr double missing_steps = 1.5;  // so long a step is one in which a sample lacks
constexpr double most_missing = 1e9;
constexpr double least_delay_s = 1e-4;  // of a filter: shorter is none to speak of

/// What the gyro's low-pass delays, where that is stated, belongs to its link's latency: for times that are
/// told at once. What is fitted afterwards has a better one.
PortProfile link_with_filter(const GyroProfile& profile) {
  PortProfile link = profile.link;
  const double delay_s = profile.stated_delay_s().value_or(0.0);
  if (delay_s > least_delay_s) link.latency_s += delay_s;
  return link;
}
}  // namespace

void GyroLosses::sample(const Stamp& stamp, const std::optional<double>& own_s, double counted) {
  if (own_s) look_at_step(stamp.time, *own_s);
  settle(stamp.arrival, own_s ? own_missing_ : counted);
}

void GyroLosses::interrupt() {
  before_ = count();
  settled_ = 0;
  own_missing_ = least_ = 0.0;
  step_count_ = 0;
  own_s_.reset();
  span_begin_.reset();
}

double GyroLosses::usual_step_s() const {
  return reordering_median(std::array(steps_s_));
}

/// A time that is not the gyro's, torn as its line may be, has no room between the two samples.
void GyroLosses::look_at_step(HostTime time, double own_s) {
  const double step_s = own_s_ ? own_s - *own_s_ : 0.0;
  const double room_s = to_s(time - time_);
  own_s_ = own_s;
  time_ = time;
  if (!(step_s > 0.0)) return;
  if (step_count_ >= kept_steps) {
    const double usual_s = usual_step_s();
    const double steps = std::min({step_s, room_s + usual_s, most_missing * usual_s}) / usual_s;
    if (step_s > missing_steps * usual_s) own_missing_ += std::max(std::round(steps) - 1.0, 0.0);
  }
  steps_s_[step_count_++ % kept_steps] = step_s;
}

void GyroLosses::settle(HostTime now, double missing) {
  if (!span_begin_) {
    span_begin_ = now;
    least_ = missing;
  }
  least_ = std::min(least_, missing);
  if (now - *span_begin_ < settling) return;
  settled_ = std::max(settled_, static_cast<std::uint64_t>(std::clamp(least_, 0.0, most_missing)));
  span_begin_ = now;
  least_ = missing;
}

GyroDecoder::GyroDecoder(const GyroProfile& profile, const Fits& fits)
    : scanner_(sensors::gyro_scanner(profile)),
      timing_(link_with_filter(profile), causal_rate_hz(fits.times[Device::gyro], profile.output_rate_hz)),
      own_clock_(profile.output_rate_hz,
                 sensors::gyro_protocol(profile.protocol).clock(profile).rate_error_max),
      final_times_(fits.times[Device::gyro]),
      axis_(static_cast<std::size_t>(profile.axis)),
      sign_(static_cast<float>(profile.sign)) {
  assert(profile.axis >= 0 && profile.axis < 3);
}

std::span<const TimedGyro> GyroDecoder::push(std::span<const std::uint8_t> chunk, HostTime arrived,
                                             std::vector<TimedGyro>& out) {
  arrived_ = arrived;
  scanner_.push(chunk, messages_);
  timing_.chunk(scanner_.counters().bytes_received, arrived);
  return take(out);
}

std::span<const TimedGyro> GyroDecoder::finish(std::vector<TimedGyro>& out) {
  scanner_.finish(messages_);
  return take(out);
}

std::span<const TimedGyro> GyroDecoder::interrupt(std::vector<TimedGyro>& out) {
  const std::size_t first = out.size();
  finish(out);
  scanner_.restart();
  timing_.restart();
  own_clock_.restart();
  losses_.interrupt();
  was_away_ = scanner_.counters().messages > 0;
  return std::span(out).subspan(first);
}

timing::StampHint GyroDecoder::hint(const wire::GyroMessage& message) {
  const bool was_unused = own_clock_.is_unused();
  const auto own_s = own_clock_.place_s(message.reading.device_time_us, arrived_);
  if (own_clock_.is_unused() && !was_unused) {
    timing_.forget_clock();
    losses_.interrupt();
  }
  return {.lost_before = message.lost_before, .device_s = own_s};
}

std::span<const TimedGyro> GyroDecoder::take(std::vector<TimedGyro>& out) {
  const std::size_t first = out.size();
  for (const wire::GyroMessage& message : messages_) {
    const timing::StampHint place = hint(message);
    out.push_back({.reading = message.reading,
                   .span = message.span,
                   .stamp = timing_.stamp(message.span, place),
                   .rate_dps = sign_ * message.reading.rate_dps[axis_],
                   .lost_before = std::exchange(was_away_, false) || message.lost_before});
    if (!final_times_.put_next(out.back().stamp))
      losses_.sample(out.back().stamp, place.device_s, timing_.missing());
  }
  messages_.clear();
  counters_ = scanner_.counters();
  counters_.lost += losses_.count();
  return std::span(out).subspan(first);
}

}  // namespace thermorig::pipeline
