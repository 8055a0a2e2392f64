// SPDX-License-Identifier: MIT
#include "clock_fits.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "ping_exchanges.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/statistics.h"
#include "thermorig/fit/clocks/recorded_clock.h"
#include "thermorig/pipeline/final_times.h"
#include "thermorig/pipeline/timing/device_time.h"
#include "thermorig/pipeline/timing/ping_clock.h"
#include "thermorig/sensors/gyro_protocol.h"
#include "thermorig/sensors/servo_protocol.h"

namespace thermorig::fit {

namespace {

std::vector<TimeEstimate> times_of(const ClockPiece& piece) {
  if (!piece.fit.times.empty()) return piece.fit.times;
  std::vector<TimeEstimate> times;
  times.reserve(piece.causal.size());
  for (const Stamp& stamp : piece.causal)
    times.push_back({stamp.time, stamp.uncertainty_s, stamp.earlier_s, stamp.later_s});
  return times;
}

std::string away_text(const std::string& device, double away_s) {
  std::array<char, 32> seconds{};
  std::snprintf(seconds.data(), seconds.size(), "%.1f", away_s);
  return "the " + device + " was away for " + seconds.data() + " s";
}

/// A mean over the messages of all pieces whose clock was fitted.
class Figures {
 public:
  void add(const ClockReport& report, double messages) {
    if (report.method.empty() || messages <= 0.0) return;
    if (own_time_unused_.empty()) own_time_unused_ = report.own_time_unused;
    messages_ += messages;
    for (std::size_t i = 0; i < means.size(); ++i) sums_[i] += messages * report.*means[i];
    for (std::size_t i = 0; i < largest.size(); ++i) most_[i] = std::max(most_[i], report.*largest[i]);
    is_checked_ = is_checked_ && report.bound_wander_ppm > 0.0;
    if (messages > most_messages_) method_ = report.method;
    most_messages_ = std::max(most_messages_, messages);
  }

  void write_to(ClockReport& report) const {
    if (messages_ <= 0.0) return;
    report.method = method_;
    report.own_time_unused = own_time_unused_;
    for (std::size_t i = 0; i < means.size(); ++i) report.*means[i] = sums_[i] / messages_;
    for (std::size_t i = 0; i < largest.size(); ++i) report.*largest[i] = most_[i];
    if (!is_checked_) report.bound_wander_ppm = 0.0;
  }

 private:
  using Member = double ClockReport::*;
  static constexpr std::array<Member, 7> means{&ClockReport::rate_hz,        &ClockReport::skew_ppm,
                                               &ClockReport::wander_ppm,     &ClockReport::late_p50_us,
                                               &ClockReport::late_p95_us,    &ClockReport::uncertainty_us,
                                               &ClockReport::bound_median_us};
  static constexpr std::array<Member, 4> largest{&ClockReport::late_max_us, &ClockReport::bound_us,
                                                 &ClockReport::bound_wander_ppm,
                                                 &ClockReport::needed_wander_ppm};
  std::array<double, 7> sums_{};
  std::array<double, largest.size()> most_{};
  bool is_checked_ = true;
  double messages_ = 0.0;
  double most_messages_ = 0.0;
  std::string method_;
  std::string own_time_unused_;
};

template <typename Item>
void append(std::vector<Item>& to, const std::vector<Item>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

ClockFit fit_one_way(const RawStream& received, std::span<const StreamSpan> spans,
                     std::span<const double> device_s, const PortProfile& link, double nominal_rate_hz) {
  const auto latest = latest_begins(received, spans, device_s, link.baud);
  ArrivalClock clock = fit_arrivals(device_s, latest, link, nominal_rate_hz);
  return {std::move(clock.times), std::move(clock.report)};
}

std::vector<double> turns_s(std::span<const labels::FrameGap> gaps, double rate_hz) {
  std::vector<double> device_s;
  double number = -1.0;
  for (const labels::FrameGap& gap : gaps) device_s.push_back((number += 1.0 + gap.missing) / rate_hz);
  return device_s;
}

/// The gyro's own time of each sample, if there is one with each, they are those of samples (`why_unused`
/// gets the reason if they are not), and no torn lines make them go faster than its clock can.
std::vector<double> own_times_s(std::span<const TimedGyro> gyro, const ClockProperties& clock,
                                double nominal_rate_hz, std::string& why_unused) {
  if (!clock.sends_time()) return {};
  std::vector<timing::OwnStamp> times;
  timing::UnwrappedTime unwrapped;
  for (const TimedGyro& sample : gyro) {
    if (!sample.reading.device_time_us) return {};
    const HostTime arrival = sample.stamp.arrival;
    times.push_back({unwrapped.unwrap_s(*sample.reading.device_time_us, arrival), arrival});
  }
  why_unused = timing::why_no_sample_times(times, nominal_rate_hz, clock.rate_error_max);
  std::vector<double> device_s;
  double forward_s = 0.0;
  for (const timing::OwnStamp& time : times) {
    if (!device_s.empty()) forward_s += std::max(0.0, time.own_s - device_s.back());
    device_s.push_back(time.own_s);
  }
  const double host_s = to_s(gyro.back().stamp.time - gyro.front().stamp.time);
  const bool is_believable = std::abs(forward_s - host_s) <= clock.rate_error_max * host_s;
  return is_believable && why_unused.empty() ? device_s : std::vector<double>{};
}

std::vector<double> counted_times_s(const RawStream& received, std::span<const TimedGyro> gyro,
                                    std::span<const StreamSpan> spans, const GyroProfile& profile) {
  const auto suspect = std::make_unique<bool[]>(gyro.size());
  std::transform(gyro.begin(), gyro.end(), suspect.get(),
                 [](const TimedGyro& sample) { return sample.lost_before; });
  const auto numbers = number_messages(earliest_proofs(received, spans, profile.link.baud),
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
  std::string why_unused;
  auto device_s = own_times_s(gyro, sensors::gyro_protocol(profile.protocol).clock(profile),
                              profile.output_rate_hz, why_unused);
  if (device_s.empty()) device_s = counted_times_s(received, gyro, spans, profile);
  ClockFit fit = fit_one_way(received, spans, device_s, profile.link, profile.output_rate_hz);
  fit.report.own_time_unused = std::move(why_unused);
  return fit;
}

ClockFit fit_servo_clock(const RawStream& received, const RawStream& sent, const pipeline::Streams& streams,
                         const ServoProfile& profile) {
  const auto spans = spans_of(streams.servo);
  const sensors::ServoProtocol& protocol = sensors::servo_protocol(profile.protocol);
  // Without a time of its own there is nothing to fit arrivals against.
  if (!holds(received, spans) || !protocol.clock.sends_time()) return {};
  const auto exchanges = ping_exchanges(received, sent, streams, profile.link.baud);
  if (exchanges.empty())
    return fit_one_way(received, spans, telemetry_times_s(streams.servo), profile.link, protocol.rate_hz);
  PingFit fit = fit_pings(mcu_times_us(streams.servo), exchanges,
                          sent_stamps(received, streams.servo, profile.link.baud), profile.link);
  return {std::move(fit.times), std::move(fit.report)};
}

std::optional<double> rate_scale_by_steps(std::span<const TimedServo> servo, double longest_gap_s) {
  constexpr double jitter_s = 0.005;  // of an arrival, by USB and the board's line
  constexpr double shortest_s = 1.0, good_enough = 0.001;
  double weights = 0.0, weighted = 0.0;
  for (std::size_t first = 0; first < servo.size();) {
    const ServoState& begin = servo[first].state;
    const auto since_s = [&](std::size_t i) { return to_s(servo[i].stamp.time - servo[first].stamp.time); };
    std::size_t end = first + 1;
    const auto goes_on = [&](const TimedServo& next) {
      return next.state.motion == ServoMotion::steady && next.state.rate_dps == begin.rate_dps &&
             !next.lost_before && to_s(next.stamp.time - servo[end - 1].stamp.time) < longest_gap_s;
    };
    if (begin.motion == ServoMotion::steady && begin.rate_dps != 0.0)
      while (end < servo.size() && goes_on(servo[end])) ++end;
    if (const double time_s = since_s(end - 1); time_s >= shortest_s) {
      LineFit angle_deg;  // by all reports: one that was read late moves it little
      for (std::size_t i = first; i < end; ++i) angle_deg.add(since_s(i), servo[i].state.angle_deg);
      const double weight = time_s * time_s / (2.0 * jitter_s * jitter_s);
      weights += weight;
      weighted += weight * angle_deg.slope() / begin.rate_dps;
    }
    first = end;
  }
  if (!(weights * good_enough * good_enough >= 1.0)) return std::nullopt;
  const double scale = weighted / weights;
  if (!(std::abs(scale - 1.0) < pipeline::most_clock_off)) return std::nullopt;
  return scale;
}

ClockFit joined(std::vector<ClockPiece> pieces, const std::string& device, double nominal_rate_hz) {
  if (pieces.empty()) return {};
  ClockFit whole;
  whole.report = pieces.front().fit.report;  // the settings, which all of them share
  whole.report.knots.clear();
  whole.report.epochs.clear();
  whole.report.gaps.clear();
  Figures figures;
  for (ClockPiece& piece : pieces) {
    const std::vector<TimeEstimate> times = times_of(piece);
    if (times.empty()) continue;
    std::vector<ClockEpoch> epochs = piece.fit.report.epochs;
    if (epochs.empty()) epochs.push_back({times.front().time, ""});
    if (!whole.times.empty()) {
      const HostTime last = whole.times.back().time;
      const HostTime first = std::max(last, times.front().time);
      const double away_s = to_s(first - last);
      epochs.front() = {first, away_text(device, away_s)};
      const double missing = std::round(away_s * nominal_rate_hz) - 1.0;
      whole.report.gaps.push_back({last, first, static_cast<std::uint64_t>(std::clamp(missing, 0.0, 1e12))});
    }
    for (TimeEstimate time : times) {
      if (!whole.times.empty()) time.time = std::max(time.time, whole.times.back().time);
      whole.times.push_back(time);
    }
    append(whole.report.epochs, epochs);
    append(whole.report.knots, piece.fit.report.knots);
    append(whole.report.gaps, piece.fit.report.gaps);
    figures.add(piece.fit.report, static_cast<double>(times.size()));
  }
  figures.write_to(whole.report);
  return whole;
}

}  // namespace thermorig::fit
