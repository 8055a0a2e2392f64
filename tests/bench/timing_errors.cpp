// SPDX-License-Identifier: MIT
#include "timing_errors.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <span>
#include <utility>

#include "servo_link.h"
#include "thermorig/fit/fit.h"
#include "thermorig/pipeline/pipeline.h"
#include "thermorig/pipeline/timing/device_time.h"
#include "thermorig/pipeline/timing/link_timing.h"
#include "thermorig/sensors/servo_protocol.h"
#include "thermorig/sensors/wire/sent_commands.h"
#include "timing_baselines.h"
#include "timing_rig.h"
#include "timing_truth.h"

namespace thermorig::bench {
namespace {

constexpr auto judged_after = std::chrono::seconds(10);  // a live clock and a regression have settled
constexpr double rounding_s = 1e-6;

float float_s(HostDuration duration) {
  return static_cast<float>(to_s(duration));
}

double host_s(HostTime time) {
  return to_s(time - bench_start());
}

void check_bounds(const TimeEstimate& estimate, HostTime truth, Errors& errors) {
  ++errors.bounded;
  errors.widths_s.push_back(estimate.earlier_s + estimate.later_s);
  const double off_s = to_s(truth - estimate.time);
  errors.later_than_bound += off_s > static_cast<double>(estimate.later_s) + rounding_s;
  errors.earlier_than_bound += -off_s > static_cast<double>(estimate.earlier_s) + rounding_s;
}

/// Times that a method made of all messages, from some instant on.
void add_method(const std::string& name, std::span<const double> times, std::span<const HostTime> truth,
                HostTime from, Errors& errors) {
  for (std::size_t i = 0; i < times.size(); ++i)
    if (truth[i] > from) errors.by_method[name].push_back(static_cast<float>(times[i] - host_s(truth[i])));
}

void add_baselines(std::span<const Arrival> arrivals, std::span<const HostTime> truth, HostTime from,
                   Errors& errors) {
  using Method = std::vector<double> (*)(std::span<const Arrival>);
  const std::array<std::pair<std::string, Method>, 4> baselines{{{"arrival", arrival_times},
                                                                 {"line", least_squares_line},
                                                                 {"rls", recursive_least_squares},
                                                                 {"hull", convex_hull_line}}};
  for (const auto& [name, method] : baselines) add_method(name, method(arrivals), truth, from, errors);
}

/// What a repeated frame shows is a frame period older than its bytes: no clock knows that, and the program
/// says that it is no frame of its own.
bool repeats(const TimedFrame& frame) {
  return frame.stale;
}
bool repeats(const TimedGyro&) {
  return false;
}

/// A stream that numbers nothing: camera or gyro.
template <typename Timed>
void judge_stream(Device device, const std::vector<Timed>& decoded, const std::vector<TimeEstimate>& final,
                  const PortProfile& link, const std::vector<simulation::SentMessage>& sent, HostTime from,
                  Errors& errors) {
  const auto truth = sent_of(decoded, sent);
  std::vector<Arrival> arrivals;
  std::vector<HostTime> instants;
  for (std::size_t i = 0; i < decoded.size(); ++i) {
    if (truth[i] == nullptr) continue;
    if (repeats(decoded[i])) {
      ++errors.repeats;
      continue;
    }
    const HostTime instant = instant_of(*truth[i], device);
    const Stamp& stamp = decoded[i].stamp;
    const double wire_s = wire_time_s(decoded[i].span.size(), link.baud);
    arrivals.push_back(
        {static_cast<double>(truth[i]->index), host_s(stamp.arrival) - wire_s - link.latency_s});
    instants.push_back(instant);
    const bool has_final = final.size() == decoded.size();
    if (has_final) check_bounds(final[i], instant, errors);
    if (instant <= from) continue;
    errors.by_method["causal"].push_back(float_s(stamp.time - instant));
    if (has_final) errors.by_method["final"].push_back(float_s(final[i].time - instant));
  }
  add_baselines(arrivals, instants, from, errors);
}

/// Pings and their answers, for the baseline that knows nothing else.
std::vector<RoundTrip> round_trips(const Recorded& recorded) {
  std::map<std::uint32_t, HostTime> pinged;
  const RawStream& sent = recorded.raw.sent[Device::servo];
  for (std::size_t i = 0; i < sent.chunk_count(); ++i)
    for (const wire::SentFrame& frame : wire::read_sent(sent.chunk(i)))
      if (frame.type == SERVO_PING) pinged[servo_get_u32(frame.payload.data())] = sent.time(i);
  std::vector<RoundTrip> trips;
  timing::McuTime mcu_time(sensors::servo_protocol("servo-link").clock);
  for (const TimedPong& pong : recorded.live.pongs) {
    const auto ping = pinged.find(pong.token);
    if (ping == pinged.end()) continue;
    const double sent_s = 1e-6 * static_cast<double>(mcu_time.unwrap(pong.send_us, pong.arrival));
    const double held_s = 1e-6 * static_cast<double>(pong.send_us - pong.receive_us);
    trips.push_back({host_s(ping->second), sent_s - held_s, sent_s, host_s(pong.arrival)});
  }
  return trips;
}

void judge_servo(const Recorded& recorded, const std::vector<TimeEstimate>& final, double wire_s,
                 HostTime from, Errors& errors) {
  std::vector<Arrival> arrivals;
  std::vector<HostTime> instants;
  std::vector<double> mcu_s;
  const auto& servo = recorded.live.servo;
  for (std::size_t i = 0; i < servo.size(); ++i) {
    const HostTime instant =
        recorded.rig->when_servo_clock_read(ServoTime(std::chrono::microseconds(servo[i].mcu_time_us)));
    mcu_s.push_back(1e-6 * static_cast<double>(servo[i].mcu_time_us));
    arrivals.push_back({mcu_s.back(), host_s(servo[i].stamp.arrival) - wire_s});
    instants.push_back(instant);
    const bool has_final = final.size() == servo.size();
    if (has_final) check_bounds(final[i], instant, errors);
    if (instant <= from) continue;
    errors.by_method["causal"].push_back(float_s(servo[i].stamp.time - instant));
    if (has_final) errors.by_method["final"].push_back(float_s(final[i].time - instant));
  }
  add_baselines(arrivals, instants, from, errors);
  const std::vector<RoundTrip> trips = round_trips(recorded);
  add_method("min_rtt", fastest_round_trips(mcu_s, trips), instants, from, errors);
  add_method("klipper", klipper_regression(mcu_s, trips), instants, from, errors);
}

/// What is constant of a recording's errors is its median.
void take_constants_off(Errors& errors) {
  for (const std::string& method : method_names()) {
    const auto& values = errors.by_method[method];
    if (values.empty()) continue;
    std::vector<float> ordered = values;
    const auto middle = ordered.begin() + static_cast<std::ptrdiff_t>(ordered.size() / 2);
    std::nth_element(ordered.begin(), middle, ordered.end());
    for (const float value : values) errors.by_method[less_constant(method)].push_back(value - *middle);
  }
}

}  // namespace

void Errors::add(const Errors& other) {
  for (const auto& [method, errors] : other.by_method) {
    auto& all = by_method[method];
    all.insert(all.end(), errors.begin(), errors.end());
  }
  widths_s.insert(widths_s.end(), other.widths_s.begin(), other.widths_s.end());
  bounded += other.bounded;
  later_than_bound += other.later_than_bound;
  earlier_than_bound += other.earlier_than_bound;
  repeats += other.repeats;
}

const std::vector<std::string>& method_names() {
  static const std::vector<std::string> names{"arrival", "line", "rls",    "min_rtt",
                                              "klipper", "hull", "causal", "final"};
  return names;
}

std::string less_constant(const std::string& method) {
  return method + ", less constant";
}

Errors judge_camera(const Recorded& recorded, const std::vector<TimeEstimate>& final, HostTime from) {
  Errors errors;
  judge_stream(Device::camera, recorded.live.frames, final, recorded.raw.header.profile.camera.link,
               recorded.rig->sent_frames(), from, errors);
  take_constants_off(errors);
  return errors;
}

PerDevice<Errors> judge(const simulation::VirtualRigConfig& config, double duration_s) {
  const Recorded recorded = record(config, {}, duration_s);
  const pipeline::Fits fits = fit::fit_recording(recorded.raw, recorded.live);
  PerDevice<Errors> errors;
  const HostTime from = config.start + judged_after;
  errors[Device::camera] = judge_camera(recorded, fits.times[Device::camera], from);
  judge_stream(Device::gyro, recorded.live.gyro, fits.times[Device::gyro], config.profile.gyro.link,
               recorded.rig->sent_gyro(), from, errors[Device::gyro]);
  const double telemetry_wire_s =
      wire_time_s(recorded.live.servo.empty() ? 0 : recorded.live.servo.front().span.size(),
                  config.profile.servo.link.baud);
  judge_servo(recorded, fits.times[Device::servo], telemetry_wire_s, from, errors[Device::servo]);
  take_constants_off(errors[Device::gyro]);
  take_constants_off(errors[Device::servo]);
  return errors;
}

}  // namespace thermorig::bench
