// SPDX-License-Identifier: MIT
#include "thermorig/rig/recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "recording_parts.h"
#include "thermorig/wire/servo_messages.h"

namespace thermorig::rig {

Recording::Recording(const RecordingOptions& options, HostTime now, Send send)
    : parts_(std::make_unique<Parts>(options, now, std::move(send))) {
  if (options.begun) options.begun(parts_->header);
  parts_->may_start = !options.wait_for_start;
  parts_->commander.greet();
}

Recording::~Recording() = default;

// ---- bytes --------------------------------------------------------------------------------------------

void Recording::received(Device from, std::span<const std::uint8_t> bytes, HostTime arrived) {
  Parts& parts = *parts_;
  parts.journal.received(from, bytes, arrived);
  parts.devices.received(from, bytes);
  parts.replug.received(from, bytes, arrived);
  const std::vector<Measurement> measurements = parts.pipeline.feed(from, bytes, arrived);
  parts.take(parts.pipeline.take_streams(), measurements, arrived);
}

// Who watches comes last: the servo's next command does not wait for a network.
void Recording::Parts::take(const pipeline::Streams& streams, const std::vector<Measurement>& measurements,
                            HostTime arrived) {
  if (!measurements.empty()) last_sample = measurements.back().sample;
  guarded(arrived, [&] { take_streams(streams, arrived); });
  for (const Measurement& measurement : measurements) sweep.sample(measurement.sample);
  observe(measurements, arrived);
}

void Recording::Parts::observe(const std::vector<Measurement>& measurements, HostTime arrived) {
  if (!options.observe) return;
  for (const Measurement& measurement : measurements)
    if (const auto row = options.observe(measurement, arrived)) journal.estimate(*row);
}

void Recording::Parts::take_streams(const pipeline::Streams& streams, HostTime arrived) {
  if (!streams.frames.empty()) journal.frame();
  for (const TimedFrame& frame : streams.frames) {
    if (devices.frame(frame, arrived, pipeline.counters(Device::camera))) replug.message(Device::camera);
    gate_watch.frame(frame);
    if (!pipeline.stands_in_for_camera()) sweep.frame(frame);
  }
  for (const TimedFrame& frame : streams.stand_ins) sweep.frame(frame);
  for (const TimedGyro& gyro : streams.gyro) {
    if (devices.gyro(gyro, arrived, pipeline.counters(Device::gyro))) {
      replug.message(Device::gyro);
      note_return(Device::gyro, arrived);
    }
    gate_watch.gyro(gyro);
  }
  for (const wire::ServoMessage& message : streams.servo_answers) commander.answer(message, arrived);
  for (const TimedPong& pong : streams.pongs)
    if (const auto round_trip = commander.pong(pong)) gate_watch.round_trip(*round_trip, arrived);
  for (const ClockEpoch& epoch : streams.servo_epochs) note_epoch(epoch, arrived);
  for (const TimedServo& servo : streams.servo) {
    if (devices.servo(servo, arrived, pipeline.counters(Device::servo))) replug.message(Device::servo);
    gate_watch.servo(servo);
    sweep.telemetry(servo);
  }
}

/// It is back after as many messages that tell something new as one that is waited for. A camera is never:
/// rows stand in for it already.
void Recording::Parts::note_return(Device device, HostTime now) {
  if (!gone[device] || ++good_while_gone[device] < Replug::messages_needed(device)) return;
  gone[device] = false;
  event({now, EventKind::device_back, device, fmt::format("{}: it is back", name_of(device))});
  listen_anew(now);
}

void Recording::Parts::note_epoch(const ClockEpoch& epoch, HostTime now) {
  if (epoch.reason.empty()) return;  // the first: nothing has gone wrong
  event({now, EventKind::warning, Device::servo, "the servo's clock starts anew: " + epoch.reason});
}

// ---- time ---------------------------------------------------------------------------------------------

void Recording::tick(HostTime now) {
  Parts& parts = *parts_;
  for (const RecordingEvent& happened : parts.journal.check(now)) parts.event(happened);
  if (done()) return;
  parts.ask_for_streams(now);
  parts.guarded(now, [&] {
    parts.check_devices(now);
    parts.look_for_returns(now);
    parts.begin_when_ready(now);
  });
  if (!parts.servo_gone) parts.guarded(now, [&] { parts.drive(now); });
  parts.drain_sweep(now);
}

void Recording::Parts::drive(HostTime now) {
  if (replug.awaits(Device::servo)) return greet_again(now);
  sweep.tick(now);
  try {
    write_to(Device::servo, commander.poll(now), now);
  } catch (const Error& error) {
    if (!commander.gave_up() || !waits()) throw;
    lose(Device::servo, error, now);
  }
}

/// The servo went: until it answers hello it is asked again and again, as long as its port is there.
void Recording::Parts::greet_again(HostTime now) {
  if (!replug.has_port(Device::servo)) return;
  try {
    write_to(Device::servo, commander.poll(now), now);
  } catch (const Error&) {
    if (!commander.gave_up()) throw;
    commander.greet();
  }
}

void Recording::Parts::ask_for_streams(HostTime now) {
  for (const Device device : all_devices)
    if (!port_lost[device])
      write_to(device, requests.due(device, pipeline.counters(device).messages, now), now);
}

void Recording::Parts::write_to(Device device, const std::vector<std::uint8_t>& bytes, HostTime now) {
  if (bytes.empty()) return;
  journal.sent(device, bytes, now);
  pipeline.sent(device, bytes, now);
  send(device, bytes);
}

void Recording::Parts::begin_when_ready(HostTime now) {
  if (began || failure || stopped || replug.awaits_any()) return;
  if (!greeting_noted && commander.greeted()) {
    greeting_noted = true;
    event({now, EventKind::info, Device::servo,
           fmt::format("firmware {} answered hello", commander.welcome()->firmware)});
  }
  const bool all_speak = std::all_of(all_devices.begin(), all_devices.end(), [&](Device device) {
    return devices.has_spoken(device) || gone[device];
  });
  if (!all_speak || !commander.greeted() || !commander.idle()) return;
  if (!std::exchange(was_ready, true)) listen_anew(now);
  gate_watch.counted(now, counts());
  if (!may_start || !passes_gate(now)) return;
  began = true;
  sweep.start(now);
}

// ---- gate ---------------------------------------------------------------------------------------------

GateCounts Recording::Parts::counts() const {
  GateCounts counts{.welcome = commander.welcome(),
                    .wire = {},
                    .pings = commander.pings(),
                    .retries = commander.retries(),
                    .gone = gone};
  for (const Device device : all_devices) counts.wire[device] = pipeline.counters(device);
  return counts;
}

GateReport Recording::Parts::judged(HostTime now) const {
  return rig::judge(gate_watch.facts(now, counts(), options.profile), options.profile);
}

/// What came before does not count: a device was away, or was not there yet.
void Recording::Parts::listen_anew(HostTime now) {
  if (was_ready && !began) gate_watch.begin(now, counts(), options.profile);
}

/// Once, before the servo is armed, which may already turn it: what is wrong is said, and refused where
/// something would move.
bool Recording::Parts::passes_gate(HostTime now) {
  if (options.gate == GateMode::off) return true;
  if (gate_watch.heard_s(now) < GateWatch::needed_s(options.profile, gone)) return false;
  gate = judged(now);
  for (const auto* found : {&gate->violations, &gate->warnings})
    for (const GateViolation& violation : *found)
      event({now, EventKind::warning, violation.device, "gate: " + sentence(violation)});
  const bool moves = !options.plan.leg_rates_dps.empty();
  const bool refused = !gate->passed() && options.gate == GateMode::refuse && moves;
  if (refused) refuse(*gate, now);
  return !refused;
}

void Recording::Parts::refuse(const GateReport& report, HostTime now) {
  const GateViolation& first = report.violations.front();
  const std::size_t more = report.violations.size() - 1;
  failure = Error(ExitCode::check_failed,
                  sentence(first) + (more == 0 ? std::string() : fmt::format(" (and {} more)", more)),
                  place_of(first.device, options.profile),
                  first.advice + "; nothing has moved and no file is left (--no-gate records all the same)");
  was_ready = false;
  sweep.request_stop(now);
}

void Recording::Parts::check_devices(HostTime now) {
  if (failure || stopped) return;
  for (const Device device : all_devices) {
    if (gone[device] || failure || replug.awaits(device)) continue;
    if (const auto trouble = devices.trouble(device, now, pipeline.counters(device)))
      lose(device, *trouble, now);
  }
}

void Recording::Parts::drain_sweep(HostTime now) {
  const SweepNews news = sweep.take_news();
  for (const RecordingEvent& happened : news.events) event(happened);
  for (const LegRecord& leg : news.legs) journal.leg(leg);
  if (sweep.done() && sweep.plan_complete() && !failure && !stopped && !std::exchange(finish_noted, true))
    event({now, EventKind::finished, std::nullopt, "the plan is complete"});
}

void Recording::Parts::event(const RecordingEvent& happened) {
  journal.event(happened);
  new_events.push_back(happened);
}

// ---- ends on request ------------------------------------------------------------------------------------

void Recording::request_stop(HostTime now, const std::string& who) {
  Parts& parts = *parts_;
  if (parts.stopped || done()) return;
  parts.stopped = true;
  parts.stopped_by = who;
  parts.event({now, EventKind::stopped, std::nullopt,
               who.empty() ? "stopped on request" : "stopped on request of " + who});
  if (parts.replug.awaits(Device::servo)) {
    // It may be there and not have answered yet: the byte alone can be sent.
    if (parts.replug.has_port(Device::servo)) parts.write_to(Device::servo, wire::stop_bytes(), now);
    parts.servo_gone = true;
  }
  parts.sweep.request_stop(now);
}

void Recording::mark(const std::string& note, HostTime now) {
  parts_->event({now, EventKind::mark, std::nullopt, note});
}

void Recording::allow_start(HostTime now) {
  Parts& parts = *parts_;
  if (std::exchange(parts.may_start, true)) return;
  parts.event({now, EventKind::info, std::nullopt, "the start was allowed"});
}

void Recording::carry_out(const Order& order, HostTime now) {
  switch (order.kind) {
    case OrderKind::stop:
      return request_stop(now, order.note);
    case OrderKind::mark:
      return mark(order.note, now);
    case OrderKind::start:
      return allow_start(now);
    case OrderKind::gate:
      return parts_->event({now, EventKind::gate, std::nullopt, order.note});
  }
}

bool Recording::done() const {
  return parts_->sweep.done() || parts_->servo_gone;
}

const std::optional<Error>& Recording::failure() const {
  return parts_->failure;
}

bool Recording::stopped() const {
  return parts_->stopped;
}

bool Recording::was_ready() const {
  return parts_->was_ready;
}

const std::string& Recording::stopped_by() const {
  return parts_->stopped_by;
}

bool Recording::keeps() const {
  return parts_->options.keep;
}

std::vector<Device> Recording::gone() const {
  std::vector<Device> gone;
  for (const Device device : all_devices)
    if (parts_->was_gone[device]) gone.push_back(device);
  return gone;
}

const std::string& Recording::gone_advice() const {
  return parts_->gone_advice;
}

const std::vector<SweepTrouble>& Recording::troubles() const {
  return parts_->sweep.troubles();
}

const SessionFile& Recording::file() const {
  return parts_->journal.file();
}

files::Disk& Recording::disk() const {
  return parts_->options.disk != nullptr ? *parts_->options.disk : files::real_disk();
}

const SweepPlan& Recording::plan() const {
  return parts_->options.plan;
}

std::optional<GateReport> Recording::gate(HostTime now) const {
  constexpr double least_s = 1.0;
  if (parts_->gate) return parts_->gate;
  if (parts_->options.gate == GateMode::off || parts_->gate_watch.heard_s(now) < least_s) return std::nullopt;
  return parts_->judged(now);
}

RecordingProgress Recording::progress(HostTime now) {
  Parts& parts = *parts_;
  RecordingProgress progress;
  progress.time = now;
  progress.elapsed_s = to_s(now - parts.begin);
  progress.sweep = parts.sweep.progress(now);
  for (const Device device : all_devices)
    progress.health[device] = parts.devices.health(device, now, parts.pipeline.counters(device));
  progress.events = std::exchange(parts.new_events, {});
  progress.last_sample = parts.last_sample;
  progress.gone = parts.gone;
  for (const Device device : all_devices)
    if (parts.replug.awaits(device))
      progress.awaited[device] = AwaitedDevice{parts.replug.why(device), parts.replug.waited_s(device, now),
                                               parts.replug.left_s(device, now)};
  progress.kept_bytes = parts.journal.bytes();
  progress.heard_s = parts.gate_watch.heard_s(now);
  progress.stopping = parts.stopped || parts.failure.has_value();
  return progress;
}

SessionFile Recording::close(HostTime now) {
  Parts& parts = *parts_;
  parts.observe(parts.pipeline.finish(), now);
  parts.drain_sweep(now);
  parts.journal.close(now);
  return file();
}

void Recording::discard(HostTime now) {
  close(now);
  parts_->journal.discard();
}

}  // namespace thermorig::rig
