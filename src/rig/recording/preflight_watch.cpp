// SPDX-License-Identifier: MIT
#include "preflight_watch.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "thermorig/core/auto_zero.h"
#include "thermorig/core/gyro_blocks.h"
#include "thermorig/core/statistics.h"
#include "thermorig/pipeline/labels/exposure.h"
#include "thermorig/pipeline/timing/device_time.h"
#include "thermorig/rig/sweep/plan.h"
#include "thermorig/sensors/gyro_protocol.h"

namespace thermorig::rig {

namespace {

constexpr double rate_window_s = 5.0;
constexpr double periods_needed = 3.0;  // of the device that sends most seldom
constexpr double periods_in_window = 5.0;
constexpr double periods_of_silence = 1.5;  // that any stream may begin and end with
constexpr auto part = std::chrono::milliseconds(500);
constexpr auto count_period = std::chrono::milliseconds(100);

double longest_period_s(const RigProfile& profile, const PerDevice<bool>& gone) {
  double longest_s = 0.0;
  for (const Device device : all_devices)
    if (!gone[device]) longest_s = std::max(longest_s, 1.0 / link_load(device, profile).rate_hz);
  return longest_s;
}

double ratio(double part_of, double whole) {
  return whole > 0.0 ? part_of / whole : 0.0;
}

/// Messages that the gaps between the device's own times have room for; 0 where it sends none. Arrivals would
/// not do: a USB link delivers several samples at once.
template <typename Entry>
double missing_by_time(const std::deque<Entry>& heard) {
  std::vector<double> steps_s;
  for (std::size_t i = 1; i < heard.size(); ++i)
    if (heard[i].device_us && heard[i - 1].device_us)
      steps_s.push_back(1e-6 * static_cast<double>(*heard[i].device_us - *heard[i - 1].device_us));
  const double period_s = median(steps_s);
  if (period_s <= 0.0) return 0.0;
  double missing = 0.0;
  for (const double step_s : steps_s) missing += std::max(0.0, std::round(step_s / period_s) - 1.0);
  return missing;
}

template <typename Entry>
std::string why_own_time_unused(const std::deque<Entry>& heard, const GyroProfile& profile) {
  std::vector<timing::OwnStamp> times;
  timing::UnwrappedTime unwrapped;
  for (const Entry& entry : heard)
    if (entry.device_us) times.push_back({unwrapped.unwrap_s(*entry.device_us, entry.time), entry.time});
  const double rate_error_max = sensors::gyro_protocol(profile.protocol).clock(profile).rate_error_max;
  return timing::why_no_sample_times(times, profile.output_rate_hz, rate_error_max);
}

/// Where halves are lost at all, what the frames lack to the nominal rate is what was lost: two of them in a
/// row change no turn, and so show in the rate alone.
double lost_half_share(double seen, const PreflightStream& camera) {
  return seen > 0.0 ? std::max(seen, 1.0 - ratio(camera.rate_hz, camera.nominal_hz)) : 0.0;
}

}  // namespace

void PreflightWatch::begin(HostTime now, const PreflightCounts& counts, const RigProfile& profile) {
  *this = PreflightWatch();
  begin_ = now;
  window_ = from_s(std::max(rate_window_s, periods_in_window * longest_period_s(profile, counts.gone)));
  counted_.push_back({now, counts});
}

double PreflightWatch::needed_s(const RigProfile& profile, const PerDevice<bool>& gone) {
  return std::max(least_s, periods_needed * longest_period_s(profile, gone));
}

void PreflightWatch::counted(HostTime now, const PreflightCounts& counts) {
  if (!begin_) return;
  if (now - counted_.back().time >= count_period) counted_.push_back({now, counts});
  while (counted_.size() > 1 && now - counted_[1].time >= window_) counted_.pop_front();
}

template <typename Entry>
void PreflightWatch::forget_old(std::deque<Entry>& entries) const {
  while (entries.back().time - entries.front().time > window_) entries.pop_front();
}

void PreflightWatch::hear(Device device, const Stamp& stamp, Heard heard) {
  heard.time = stamp.arrival;
  heard.uncertainty_s = double{stamp.uncertainty_s};
  heard_[device].push_back(heard);
  forget_old(heard_[device]);
}

void PreflightWatch::frame(const TimedFrame& frame) {
  if (!begin_) return;
  hear(Device::camera, frame.stamp, {.missing_before = frame.missing_before});
  const labels::Freshness fresh{frame.fresh_even, frame.fresh_odd};
  images_.push_back({frame.stamp.arrival, fresh.even_fresh(), fresh.odd_fresh(), fresh.none_fresh(),
                     frame.stale && fresh.one_fresh(), double{frame.frame.sensor_temp_c}});
  forget_old(images_);
}

void PreflightWatch::gyro(const TimedGyro& gyro) {
  if (!begin_) return;
  hear(Device::gyro, gyro.stamp, {.device_us = gyro.reading.device_time_us});
  rates_.push_back({gyro.stamp.arrival, gyro});
  forget_old(rates_);
}

void PreflightWatch::servo(const TimedServo& servo) {
  if (begin_) hear(Device::servo, servo.stamp, {});
}

void PreflightWatch::round_trip(HostDuration time, HostTime arrived) {
  if (!begin_) return;
  round_trips_.push_back({arrived, to_s(time)});
  forget_old(round_trips_);
}

// ---- figures ------------------------------------------------------------------------------------------

PreflightFacts PreflightWatch::facts(HostTime now, const PreflightCounts& counts,
                                     const RigProfile& profile) const {
  PreflightFacts facts{.span_s = std::min(heard_s(now), to_s(window_))};
  for (const Device device : all_devices) facts.streams[device] = stream(device, now, counts, profile);
  facts.images = images();
  if (facts.images && facts.streams[Device::camera])
    facts.images->lost_half_share =
        lost_half_share(facts.images->lost_half_share, *facts.streams[Device::camera]);
  facts.rest = rest();
  if (facts.streams[Device::servo]) facts.answers = answers(counts);
  return facts;
}

/// From the first message to the last; what is silent before or behind them for longer than a stream of that
/// period may be counts as well.
double PreflightWatch::span_s(Device device, HostTime now, double period_s) const {
  const auto& heard = heard_[device];
  const HostDuration silence = from_s(periods_of_silence * period_s);
  const HostTime begin = std::min(heard.front().time, std::max(*begin_, now - window_) + silence);
  return to_s(std::max(heard.back().time, now - silence) - begin);
}

/// None: the device is not there, which is known, or it is too early to tell. One that is and sends too
/// little has a rate all the same.
std::optional<PreflightStream> PreflightWatch::stream(Device device, HostTime now,
                                                      const PreflightCounts& counts,
                                                      const RigProfile& profile) const {
  const auto& heard = heard_[device];
  const double nominal_hz = link_load(device, profile).rate_hz;
  if (heard.size() < 2 && (counts.gone[device] || heard_s(now) * nominal_hz < periods_needed))
    return std::nullopt;
  const wire::Counters& after = counts.wire[device];
  const wire::Counters& before = counted_.front().counts.wire[device];
  PreflightStream stream{.messages = heard.size(), .nominal_hz = nominal_hz};
  if (heard.size() > 1)
    stream.rate_hz = ratio(static_cast<double>(heard.size() - 1), span_s(device, now, 1.0 / nominal_hz));
  double missing = static_cast<double>(after.lost - before.lost);
  for (const Heard& one : heard) missing += one.missing_before;
  if (device == Device::gyro) {
    stream.own_time_unused = why_own_time_unused(heard, profile.gyro);
    if (stream.own_time_unused.empty()) missing = std::max(missing, missing_by_time(heard));
  }
  stream.lost_share = ratio(missing, missing + static_cast<double>(heard.size()));
  const auto without_message = [](const wire::Counters& counters) {
    return counters.bytes_skipped - counters.bytes_in_filler + counters.bytes_in_damaged;
  };
  const auto damaged = static_cast<double>(without_message(after) - without_message(before));
  stream.damaged_share = ratio(damaged, static_cast<double>(after.bytes_received - before.bytes_received));
  if (!heard.empty()) stream.uncertainty_s = heard.back().uncertainty_s;
  return stream;
}

std::optional<PreflightImages> PreflightWatch::images() const {
  if (images_.size() < 2) return std::nullopt;
  const auto share_of = [this](auto is_so) {
    return ratio(static_cast<double>(std::count_if(images_.begin(), images_.end(), is_so)),
                 static_cast<double>(images_.size()));
  };
  PreflightImages facts{.frames = images_.size(),
                        .even_fresh_share = share_of([](const Image& image) { return image.even; }),
                        .odd_fresh_share = share_of([](const Image& image) { return image.odd; }),
                        .repeated_share = share_of([](const Image& image) { return image.repeats; })};
  const double lost_halves = share_of([](const Image& image) { return image.half_lost; });
  facts.lost_half_share = lost_halves / (1.0 + lost_halves);
  LineFit warming;
  for (const Image& image : images_)
    warming.add(to_s(image.time - images_.front().time) / 60.0, image.sensor_c);
  facts.sensor_drift_c_per_min = warming.slope();
  return facts;
}

std::optional<PreflightRest> PreflightWatch::rest() const {
  if (rates_.size() < 2) return std::nullopt;
  PreflightRest facts;
  AutoZero zeros;
  for (const Rate& rate : rates_) zeros.add(rate.sample.reading);
  facts.zeroes_itself = zeros.is_seen();
  GyroBlock all;
  std::vector<GyroBlock> parts;
  for (const auto& [time, sample] : rates_) {
    // The step from its bias to zero is none that the rig made.
    if (facts.zeroes_itself && sample.reading.is_zero()) continue;
    if (parts.empty() || time - parts.back().begin >= part)
      parts.push_back({.begin = time, .shaft_dps = {}, .axes_dps = {}});
    all.add(sample);
    parts.back().add(sample);
  }
  if (parts.empty()) return facts;
  parts.pop_back();  // which is not over
  facts.mean_dps = all.mean_dps();
  facts.noise_dps = all.largest_deviation_dps();
  for (std::size_t axis = 0; axis < 3 && !parts.empty(); ++axis) {
    const auto mean = [axis](const GyroBlock& block) { return block.axes_dps[axis].mean(); };
    const auto [least, most] = std::ranges::minmax(parts, {}, mean);
    facts.swing_dps = std::max(facts.swing_dps, mean(most) - mean(least));
  }
  return facts;
}

PreflightAnswers PreflightWatch::answers(const PreflightCounts& counts) const {
  constexpr std::uint64_t on_their_way = 1;  // the last answer may not have come yet
  const PreflightCounts& before = counted_.front().counts;
  const std::uint64_t sent = counts.requests - before.requests;
  PreflightAnswers facts{.requests = sent > on_their_way ? sent - on_their_way : 0,
                         .retries = counts.retries - before.retries};
  std::vector<double> round_trips_s;
  for (const RoundTrip& one : round_trips_)
    if (one.time >= counted_.front().time) round_trips_s.push_back(one.took_s);
  facts.answered = std::min<std::uint64_t>(round_trips_s.size(), facts.requests);
  facts.round_trip_s = median(std::move(round_trips_s));
  facts.how_it_rests = counts.how_servo_rests;
  if (!counts.welcome) return facts;
  facts.firmware = counts.welcome->firmware;
  facts.uptime_s = 1e-6 * counts.welcome->uptime_us;
  facts.reset_cause = counts.welcome->reset_cause;
  facts.limit_rate_dps = counts.welcome->limit_rate_dps;
  facts.watchdog_ms = counts.welcome->watchdog_ms;
  return facts;
}

}  // namespace thermorig::rig
