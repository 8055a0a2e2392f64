// SPDX-License-Identifier: MIT
#include "board_odometer.h"

#include <chrono>

namespace thermorig::tests {
namespace {

constexpr std::uint16_t fresh_pixels = 7;  // of 384: fewer are noise

std::uint32_t microseconds(HostTime time, HostTime origin) {
  return static_cast<std::uint32_t>(
      std::chrono::duration_cast<std::chrono::microseconds>(time - origin).count());
}

template <class Value>
void append(std::string& bytes, const Value& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

EstimateState state_of(const thermorig_odometer_output& output) {
  switch (output.state) {
    case THERMORIG_ODOMETER_STARTING:
      return EstimateState::starting;
    case THERMORIG_ODOMETER_TRACKING:
      return EstimateState::good;
    case THERMORIG_ODOMETER_RELOCALISING:
      return EstimateState::relocalising;
    default:
      return EstimateState::not_trusted;
  }
}

}  // namespace

BoardFrame::BoardFrame(const TimedFrame& timed, std::span<const TimedGyro> samples,
                       const GyroProfile& profile, HostTime origin)
    : end_us(microseconds(timed.exposure_end, origin)) {
  for (const TimedGyro& sample : samples) {
    std::array<float, 3> rate_dps = sample.reading.rate_dps;
    rate_dps[static_cast<std::size_t>(profile.axis)] = static_cast<float>(profile.sign) * sample.rate_dps;
    gyro.push_back({microseconds(sample.stamp.time, origin), rate_dps, sample.reading.saturated ? 1U : 0U});
  }
  frame.temp_c = timed.frame.temp_c.data();
  if (!timed.late && !timed.stale && !timed.stands_in)
    frame.fresh = (timed.fresh_even > fresh_pixels ? 1U : 0U) | (timed.fresh_odd > fresh_pixels ? 2U : 0U);
  for (const std::size_t parity : {0U, 1U}) {
    frame.begin_us[parity] = microseconds(timed.half[parity].begin, origin);
    frame.end_us[parity] = microseconds(timed.half[parity].end, origin);
  }
  frame.time_sigma_s = timed.stamp.uncertainty_s;
}

void BoardFrame::append_to(std::string& bytes) const {
  for (const Sample& sample : gyro) {
    append(bytes, std::uint32_t{1});
    append(bytes, sample);
  }
  append(bytes, std::uint32_t{2});
  append(bytes, std::array{frame.fresh, frame.begin_us[0], frame.begin_us[1], frame.end_us[0],
                           frame.end_us[1], end_us});
  append(bytes, frame.time_sigma_s);
  bytes.append(reinterpret_cast<const char*>(frame.temp_c), frame_pixels * sizeof(float));
}

BoardOdometer::BoardOdometer(const RigProfile& rig, HostDuration running)
    : gyro_(rig.gyro),
      profile_(board_odometer::board_profile(rig)),
      state_(std::make_shared<thermorig_odometer_state>()),
      running_(running) {
  thermorig_odometer_reset(state_.get(), &profile_);
}

thermorig_odometer_output BoardOdometer::read_after(double seconds) const {
  thermorig_odometer_output later;
  thermorig_odometer_read(state_.get(), end_us_ + static_cast<std::uint32_t>(1e6 * seconds), &later);
  return later;
}

RateEstimate BoardOdometer::add(const TimedFrame& frame, std::span<const TimedGyro> gyro) {
  if (origin_ == HostTime{}) origin_ = frame.exposure_begin - running_;
  const BoardFrame told(frame, gyro, gyro_, origin_);
  for (const BoardFrame::Sample& sample : told.gyro)
    thermorig_odometer_push_gyro(state_.get(), sample.time_us, sample.rate_dps.data(),
                                 static_cast<int>(sample.saturated));
  thermorig_odometer_push_frame(state_.get(), &told.frame);
  end_us_ = told.end_us;
  thermorig_odometer_read(state_.get(), end_us_, &output_);
  RateEstimate estimate;
  estimate.rate_dps = output_.rate_dps;
  estimate.rate_sigma_dps = output_.rate_sigma_dps;
  estimate.angle_deg = 360.0 * output_.turns + double{output_.heading_deg};
  estimate.angle_sigma_deg = output_.heading_sigma_deg;
  estimate.state = state_of(output_);
  estimate.values = {output_.bias_dps, output_.scale, output_.latency_s, output_.nis};
  return estimate;
}

}  // namespace thermorig::tests
