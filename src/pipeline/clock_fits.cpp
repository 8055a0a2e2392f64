// SPDX-License-Identifier: MIT
#include "clock_fits.h"

#include <algorithm>
#include <memory>

#include "message_spans.h"
#include "ping_exchanges.h"
#include "thermorig/pipeline/timing/arrivals.h"
#include "thermorig/pipeline/timing/ping_clock.h"
#include "thermorig/sensors/gyro_protocol.h"
#include "thermorig/sensors/servo_protocol.h"

namespace thermorig::pipeline {

namespace {

ClockFit fit_one_way(const RawStream& received, std::span<const StreamSpan> spans,
                     std::span<const double> device_s, const PortProfile& link, double nominal_rate_hz) {
  const auto latest = timing::latest_begins(received, spans, device_s, link.baud);
  timing::ArrivalClock clock = timing::fit_arrivals(device_s, latest, link, nominal_rate_hz);
  return {std::move(clock.times), std::move(clock.report)};
}

std::vector<double> turns_s(std::span<const labels::FrameGap> gaps, double rate_hz) {
  std::vector<double> device_s;
  double number = -1.0;
  for (const labels::FrameGap& gap : gaps) device_s.push_back((number += 1.0 + gap.missing) / rate_hz);
  return device_s;
}

/// The gyro's own time of each sample, if there is one with each and they go as fast as its clock can be.
std::vector<double> own_times_s(std::span<const TimedGyro> gyro, const ClockProperties& clock) {
  if (!clock.sends_time()) return {};
  std::vector<double> device_s;
  double forward_s = 0.0;
  for (const TimedGyro& sample : gyro) {
    if (!sample.reading.device_time_us) return {};
    const double time_s = 1e-6 * static_cast<double>(*sample.reading.device_time_us);
    if (!device_s.empty()) forward_s += std::max(0.0, time_s - device_s.back());
    device_s.push_back(time_s);
  }
  const double host_s = to_s(gyro.back().stamp.time - gyro.front().stamp.time);
  const bool is_believable = std::abs(forward_s - host_s) <= clock.rate_error_max * host_s;
  return is_believable ? device_s : std::vector<double>{};
}

std::vector<double> counted_times_s(const RawStream& received, std::span<const TimedGyro> gyro,
                                    std::span<const StreamSpan> spans, const GyroProfile& profile) {
  const auto suspect = std::make_unique<bool[]>(gyro.size());
  std::transform(gyro.begin(), gyro.end(), suspect.get(),
                 [](const TimedGyro& sample) { return sample.lost_before; });
  const auto numbers = timing::number_messages(timing::earliest_proofs(received, spans, profile.link.baud),
                                               std::span(suspect.get(), gyro.size()), profile.output_rate_hz);
  std::vector<double> device_s;
  device_s.reserve(numbers.size());
  for (const std::int64_t number : numbers)
    device_s.push_back(static_cast<double>(number) / profile.output_rate_hz);
  return device_s;
}

std::vector<double> telemetry_times_s(const std::vector<TimedServo>& servo) {
  std::vector<double> device_s;
  for (const TimedServo& state : servo) device_s.push_back(1e-6 * static_cast<double>(state.mcu_time_us));
  return device_s;
}

}  // namespace

ClockFit fit_camera_clock(const RawStream& received, std::span<const TimedFrame> frames,
                          std::span<const labels::FrameGap> gaps, const CameraProfile& profile) {
  const auto spans = spans_of(frames);
  if (!holds(received, spans) || gaps.size() != frames.size()) return {};
  const auto device_s = turns_s(gaps, profile.output_rate_hz);
  return fit_one_way(received, spans, device_s, profile.link, profile.output_rate_hz);
}

ClockFit fit_gyro_clock(const RawStream& received, std::span<const TimedGyro> gyro,
                        const GyroProfile& profile) {
  const auto spans = spans_of(gyro);
  if (!holds(received, spans)) return {};
  auto device_s = own_times_s(gyro, sensors::gyro_protocol(profile.protocol).clock(profile));
  if (device_s.empty()) device_s = counted_times_s(received, gyro, spans, profile);
  return fit_one_way(received, spans, device_s, profile.link, profile.output_rate_hz);
}

ClockFit fit_servo_clock(const RawStream& received, const RawStream& sent, const Streams& streams,
                         const ServoProfile& profile) {
  const auto spans = spans_of(streams.servo);
  if (!holds(received, spans)) return {};
  const auto exchanges = ping_exchanges(received, sent, streams, profile.link.baud);
  if (exchanges.empty())
    return fit_one_way(received, spans, telemetry_times_s(streams.servo), profile.link,
                       sensors::servo_protocol().rate_hz);
  timing::PingFit fit =
      timing::fit_pings(mcu_times_us(streams.servo), exchanges,
                        sent_stamps(received, streams.servo, profile.link.baud), profile.link);
  return {std::move(fit.times), std::move(fit.report)};
}

}  // namespace thermorig::pipeline
