// SPDX-License-Identifier: MIT
#include "thermorig/rig/recording/recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "recording_parts.h"
#include "thermorig/io/port.h"
#include "thermorig/sensors/servo_protocol.h"

namespace thermorig::rig {

Recording::Recording(const RecordingOptions& options, HostTime now, Send send)
    : parts_(std::make_unique<Parts>(options, now, std::move(send))) {
  if (options.begun) options.begun(parts_->header);
  if (parts_->has_servo()) parts_->commander.greet();
}

Recording::~Recording() = default;

// ---- bytes --------------------------------------------------------------------------------------------

void Recording::received(Device from, std::span<const std::uint8_t> bytes, HostTime arrived) {
  Parts& parts = *parts_;
  parts.journal.received(from, bytes, arrived);
  parts.devices.received(from, bytes);
  parts.presence[from].received(bytes, arrived);
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
  for (const TimedFrame& frame : streams.frames) {
    if (devices.frame(frame, arrived)) presence[Device::camera].message();
    start.watch().frame(frame);
    if (!pipeline.stands_in_for_camera()) sweep.frame(frame);
  }
  for (const TimedFrame& frame : streams.stand_ins) sweep.frame(frame);
  for (const TimedGyro& gyro : streams.gyro) {
    if (devices.gyro(gyro, arrived)) {
      presence[Device::gyro].message();
      note_return(Device::gyro, arrived);
    }
    start.watch().gyro(gyro);
    witnesses.gyro(gyro);
  }
  for (const wire::ServoMessage& message : streams.servo_answers) commander.answer(message, arrived);
  for (const TimedPong& pong : streams.pongs)
    if (const auto round_trip = commander.pong(pong)) start.watch().round_trip(*round_trip, arrived);
  for (const ClockEpoch& epoch : streams.servo_epochs) note_epoch(epoch, arrived);
  for (const TimedServo& servo : streams.servo) {
    if (devices.servo(servo, arrived)) presence[Device::servo].message();
    start.watch().servo(servo);
    if (const auto round_trip = commander.telemetry(servo)) start.watch().round_trip(*round_trip, arrived);
    sweep.telemetry(servo);
    if (const auto contradiction = witnesses.servo(servo))
      event({arrived, EventKind::warning, std::nullopt, *contradiction});
  }
}

/// It is back after as many messages that tell something new as one that is waited for. A camera is never:
/// rows stand in for it already.
void Recording::Parts::note_return(Device device, HostTime now) {
  if (!presence[device].is_done_without() || !presence[device].is_back()) return;
  presence[device].come_back();
  event({now, EventKind::device_back, device, fmt::format("{}: it is back", name_of(device))});
  start.listen_anew(now, counts());
}

void Recording::Parts::note_epoch(const ClockEpoch& epoch, HostTime now) {
  if (epoch.reason.empty()) return;  // the first: nothing has gone wrong
  event({now, EventKind::warning, Device::servo, "the servo's clock was reset: " + epoch.reason});
}

/// Said the first time, then ever more rarely: a device may change to and fro.
void Recording::Parts::note_layout(HostTime now) {
  const std::uint64_t changes = pipeline.counters(Device::gyro).layout_changes;
  if (changes < layout_changes_to_say) return;
  layout_changes_to_say = 2 * changes;
  event({now, EventKind::warning, Device::gyro,
         "the number of columns on the gyro's lines has changed: they may mean something else now; try: "
         "thermorig decode --device gyro on what it prints"});
}

// ---- time ---------------------------------------------------------------------------------------------

void Recording::tick(HostTime now) {
  Parts& parts = *parts_;
  for (const RecordingEvent& happened : parts.journal.check(now)) parts.event(happened);
  if (done()) return;
  parts.note_layout(now);
  parts.ask_for_streams(now);
  parts.guarded(now, [&] {
    parts.check_devices(now);
    parts.look_for_returns(now);
    parts.begin_when_ready(now);
  });
  if (!parts.end.servo_is_gone) parts.guarded(now, [&] { parts.drive(now); });
  parts.drain_sweep(now);
}

void Recording::Parts::drive(HostTime now) {
  if (presence[Device::servo].is_awaited()) return greet_again(now);
  sweep.tick(now);
  if (!has_servo()) return;
  try {
    write_to(Device::servo, commander.poll(now), now);
  } catch (const Error& error) {
    if (!commander.gave_up() || !waits()) throw;
    lose(Device::servo, error, now);
  }
}

/// The servo went: until it answers hello it is asked again and again, as long as its port is there.
void Recording::Parts::greet_again(HostTime now) {
  if (!presence[Device::servo].has_port()) return;
  try {
    write_to(Device::servo, commander.poll(now), now);
  } catch (const Error&) {
    if (!commander.gave_up()) throw;
    commander.greet();
  }
}

void Recording::Parts::ask_for_streams(HostTime now) {
  for (const Device device : all_devices)
    if (presence[device].has_port())
      write_to(
          device,
          requests.due(device, pipeline.counters(device).messages, now, pipeline.counters(device).bad_value),
          now);
}

void Recording::Parts::write_to(Device device, const std::vector<std::uint8_t>& bytes, HostTime now) {
  if (bytes.empty()) return;
  journal.sent(device, bytes, now);
  pipeline.sent(device, bytes, now);
  send(device, bytes);
}

void Recording::Parts::begin_when_ready(HostTime now) {
  if (start.has_begun() || end.is_coming() || awaits_any()) return;
  if (has_servo() && commander.greeted() && start.greeted())
    event({now, EventKind::info, Device::servo, "servo found: firmware " + commander.welcome()->firmware});
  const bool all_speak = std::all_of(all_devices.begin(), all_devices.end(), [&](Device device) {
    return devices.has_spoken(device) || presence[device].is_done_without();
  });
  const bool can_be_driven = !has_servo() || (commander.greeted() && commander.idle());
  if (!all_speak || !can_be_driven) return;
  start.ready(now, counts());
  if (!start.is_due(now, counts())) return;
  if (const auto report = start.judged()) {
    for (const PreflightViolation& violation : report->violations)
      event({now, EventKind::warning, violation.device, "preflight: " + sentence(violation)});
    for (const PreflightViolation& warning : report->warnings)
      event({now, EventKind::warning, warning.device,
             "preflight: " + sentence(warning) + "; try: " + warning.advice});
    if (start.is_to_be_refused()) return refuse(*report, now);
  }
  start.begin();
  sweep.start(now);
}

PerDevice<bool> Recording::Parts::done_without() const {
  PerDevice<bool> without;
  for (const Device device : all_devices) without[device] = presence[device].is_done_without();
  return without;
}

PreflightCounts Recording::Parts::counts() const {
  PreflightCounts counts{.welcome = commander.welcome(),
                         .wire = {},
                         .requests = commander.requests(),
                         .retries = commander.retries(),
                         .how_servo_rests = commander.how_it_rests(),
                         .gone = done_without()};
  for (const Device device : all_devices) counts.wire[device] = pipeline.counters(device);
  return counts;
}

void Recording::Parts::refuse(const PreflightReport& report, HostTime now) {
  const PreflightViolation& first = report.violations.front();
  const std::size_t more = report.violations.size() - 1;
  end.failure = Error(ExitCode::check_failed,
                      sentence(first) + (more == 0 ? std::string() : fmt::format(" (and {} more)", more)),
                      place_of(first.device, options.profile),
                      first.advice + "; nothing moved, no file was kept (--no-preflight records anyway)");
  start.refuse();
  sweep.request_stop(now);
}

void Recording::Parts::check_devices(HostTime now) {
  for (const Device device : all_devices) {
    if (end.is_coming() || !presence[device].is_there()) continue;
    if (const auto trouble = devices.trouble(device, now)) lose(device, *trouble, now);
  }
}

void Recording::Parts::drain_sweep(HostTime now) {
  const SweepNews news = sweep.take_news();
  for (const RecordingEvent& happened : news.events) event(happened);
  for (const LegRecord& leg : news.legs) journal.leg(leg);
  if (news.is_complete) event({now, EventKind::finished, std::nullopt, "the plan is complete"});
}

void Recording::Parts::event(const RecordingEvent& happened) {
  journal.event(happened);
  new_events.push_back(happened);
}

// ---- ends on request ------------------------------------------------------------------------------------

void Recording::request_stop(HostTime now, const std::string& who) {
  Parts& parts = *parts_;
  if (parts.end.stopped_by || done()) return;
  parts.end.stopped_by = who;
  parts.event({now, EventKind::stopped, std::nullopt,
               who.empty() ? "stopped on request" : "stopped on request of " + who});
  if (parts.options.plan.ends_by_stop())
    parts.event({now, EventKind::finished, std::nullopt, "complete: this plan runs until it is stopped"});
  const DevicePresence& servo = parts.presence[Device::servo];
  if (servo.is_awaited()) {
    // It may be there and not have answered yet: the byte alone can be sent.
    if (servo.has_port())
      parts.write_to(Device::servo,
                     sensors::servo_protocol(parts.options.profile.servo.protocol).emergency_bytes(), now);
    parts.end.servo_is_gone = true;
  }
  parts.sweep.request_stop(now);
}

void Recording::mark(const std::string& note, HostTime now) {
  parts_->event({now, EventKind::mark, std::nullopt, note});
}

void Recording::allow_start(HostTime now) {
  Parts& parts = *parts_;
  if (!parts.start.allow()) return;
  parts.event({now, EventKind::info, std::nullopt, "started"});
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
    case OrderKind::info:
      return parts_->event({now, EventKind::info, std::nullopt, order.note});
  }
}

bool Recording::done() const {
  return parts_->sweep.done() || parts_->end.servo_is_gone;
}

RecordingOutcome Recording::outcome(HostTime now) const {
  const Parts& parts = *parts_;
  RecordingOutcome outcome{.is_kept = parts.options.keep,
                           .was_ready = parts.start.was_ready(),
                           .failure = parts.end.failure,
                           .stopped_by = parts.end.stopped_by,
                           .gone = {},
                           .gone_advice = parts.gone_advice,
                           .absences = parts.absences,
                           .troubles = parts.sweep.troubles(),
                           .preflight = parts.start.report(now, parts.counts())};
  for (const Device device : all_devices)
    if (parts.presence[device].was_done_without()) outcome.gone.push_back(device);
  return outcome;
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

RecordingProgress Recording::progress(HostTime now) {
  Parts& parts = *parts_;
  RecordingProgress progress;
  progress.time = now;
  progress.elapsed_s = to_s(now - parts.begin);
  progress.sweep = parts.sweep.progress(now);
  for (const Device device : all_devices) {
    progress.health[device] = parts.devices.health(device, now, parts.pipeline.counters(device));
    progress.awaited[device] = parts.presence[device].awaited(now);
    progress.absent[device] = !parts.options.profile.has(device);
  }
  progress.events = std::exchange(parts.new_events, {});
  progress.last_sample = parts.last_sample;
  progress.gone = parts.done_without();
  progress.kept_bytes = parts.journal.bytes();
  progress.heard_s = parts.start.heard_s(now);
  progress.stopping = parts.end.is_coming();
  return progress;
}

void Recording::Parts::close(HostTime now) {
  observe(pipeline.finish(), now);
  drain_sweep(now);
  journal.close(now);
}

/// A computer without a battery for its clock learns the time from the network, at any moment.
SessionFile Recording::close(HostTime now) {
  Parts& parts = *parts_;
  const std::int64_t set_ns =
      clock_set_ns(parts.wall_offset_ns, wall_offset_ns(parts.options), to_s(now - parts.begin));
  if (set_ns != 0)
    parts.event({now, EventKind::warning, std::nullopt,
                 fmt::format("the computer's clock was set by {:+.1f} s during the recording: the session's "
                             "name and start use the new time; intervals are correct",
                             1e-9 * static_cast<double>(set_ns))});
  parts.close(now);
  if (set_ns == 0 || !parts.options.keep) return file();
  const std::string start_utc =
      io::utc_text(parts.header.time_reference, parts.header.realtime_offset_ns + set_ns);
  SessionFile renamed = dated(file(), compact_utc(start_utc), disk());
  renamed.clock_set_ns = set_ns;
  return renamed;
}

void Recording::discard(HostTime now) {
  parts_->close(now);
  parts_->journal.discard();
}

}  // namespace thermorig::rig
