// SPDX-License-Identifier: MIT
// Devices of a recording that go: what ends it, what it waits for, and what it does without.
#include <fmt/format.h>

#include <utility>

#include "recording_parts.h"
#include "thermorig/wire/servo_messages.h"

namespace thermorig::rig {

void Recording::Parts::fail(const Error& error, HostTime now) {
  const bool first = !failure;
  if (first) {
    failure = error;
    event({now, EventKind::device_lost, std::nullopt, error.where() + ": " + error.what_happened()});
  }
  // A servo that does not answer cannot be stopped from here; its watchdog does it.
  if (!first || sweep.phase() == SweepPhase::stopping || replug.awaits(Device::servo)) servo_gone = true;
  if (!servo_gone) sweep.request_stop(now);
}

/// A device is not there, or no more: the end, or an event where the recording can do without it.
void Recording::Parts::lose(Device device, const Error& error, HostTime now, bool has_port) {
  port_lost[device] = !has_port;
  if (replug.awaits(device)) return has_port ? void() : lose_port_again(device, error, now);
  good_while_gone[device] = 0;
  if (gone[device]) return;
  if (device != Device::servo && is_halting()) return miss_at_the_end(device, error, now);
  const bool all_gone = gone[Device::camera] || gone[Device::gyro];  // the other one goes now
  if (is_needed(device) || all_gone) {
    if (waits()) return await(device, error, has_port, now);
    if (device == Device::servo) servo_gone = devices.has_spoken(device) || !has_port;
    return fail(error, now);
  }
  interrupt(device, now);
  if (gone_advice.empty()) gone_advice = error.advice();
  gone[device] = was_gone[device] = true;
  if (device == Device::camera) pipeline.stand_in_for_camera(now);
  event({now, EventKind::missing, device,
         fmt::format("{}: {}; going on without it", error.where(), error.what_happened())});
}

/// The plan is complete, nothing more is asked of any device but the servo.
bool Recording::Parts::is_halting() const {
  return sweep.phase() == SweepPhase::halting && sweep.plan_complete() && !failure && !stopped;
}

void Recording::Parts::miss_at_the_end(Device device, const Error& error, HostTime now) {
  gone[device] = true;
  port_lost[device] = false;  // it is not looked for: what it sent then would be another stream
  event({now, EventKind::warning, device,
         fmt::format("{}: {}, behind the last frame of the plan", error.where(), error.what_happened())});
}

void Recording::lost(Device device, const std::string& why, HostTime now) {
  Parts& parts = *parts_;
  const Error error(ExitCode::device_lost, why, place_of(device, parts.options.profile),
                    "check cable and power, then record again");
  parts.guarded(now, [&] { parts.lose(device, error, now, false); });
}

void Recording::missing(Device device, const Error& why, HostTime now) {
  Parts& parts = *parts_;
  parts.lose(device,
             Error(why.code(), why.what_happened(), place_of(device, parts.options.profile), why.advice()),
             now, false);
}

// ---- devices that go and come back ----------------------------------------------------------------------

/// Before the rig was ready nothing is lost by an end; after that the end of the plan needs nobody but the
/// servo.
bool Recording::Parts::waits() const {
  return options.replug_patience_s > 0.0 && was_ready && !failure && !stopped &&
         sweep.phase() != SweepPhase::halting && sweep.phase() != SweepPhase::stopping && !sweep.done();
}

void Recording::Parts::await(Device device, const Error& error, bool has_port, HostTime now) {
  event({now, EventKind::device_lost, device,
         fmt::format("{}: {}; waiting up to {:.0f} s for it", error.where(), error.what_happened(),
                     options.replug_patience_s)});
  interrupt(device, now);
  replug.gone(device, error, has_port, now);
  sweep.suspend(now, error);
  if (device == Device::servo) commander.greet();  // all that it was told is forgotten, and so is what waits
}

/// It was open once more, and is gone again: what it sent then was a stream of its own.
void Recording::Parts::lose_port_again(Device device, const Error& error, HostTime now) {
  if (!replug.has_port(device)) return;
  replug.port_lost(device);
  event({now, EventKind::device_lost, device,
         fmt::format("{}: {} again", error.where(), error.what_happened())});
  interrupt(device, now);
  if (device == Device::servo) commander.greet();
}

/// From here on the device's bytes are a stream anew: the same in a replay, which knows it from the event.
void Recording::Parts::interrupt(Device device, HostTime now) {
  devices.forget(device);
  const std::vector<Measurement> measurements = pipeline.interrupt(device, now);
  take(pipeline.take_streams(), measurements, now);
}

void Recording::Parts::look_for_returns(HostTime now) {
  if (!replug.awaits_any() || failure || stopped) return;
  for (const Device device : all_devices) {
    const bool answers = device != Device::servo || (commander.greeted() && commander.idle());
    if (answers && replug.is_back(device)) note_back(device, now);
  }
  if (!replug.awaits_any()) {
    listen_anew(now);
    return sweep.go_on(now);
  }
  if (const auto verdict = replug.verdict(now)) fail(*verdict, now);
}

void Recording::Parts::note_back(Device device, HostTime now) {
  const HostTime since = replug.forget(device);
  absences.push_back({device, since, now});
  event({now, EventKind::device_back, device,
         fmt::format("{}: it is back after {:.1f} s; its clock begins anew",
                     place_of(device, options.profile), to_s(now - since))});
}

void Recording::returned(Device device, HostTime now) {
  Parts& parts = *parts_;
  parts.port_lost[device] = false;
  parts.requests.port_opened(device);
  parts.replug.port_opened(device, now);
}

void Recording::refused(Device device, const Error& why, HostTime now) {
  Parts& parts = *parts_;
  if (parts.failure || parts.stopped) return;
  if (parts.gone[device])
    parts.event({now, EventKind::warning, device,
                 fmt::format("{}: it is back, but {}; going on without it",
                             place_of(device, parts.options.profile), why.what_happened())});
  if (!parts.replug.awaits(device)) return;
  parts.fail(Error(why.code(), "it is back, but " + why.what_happened(),
                   place_of(device, parts.options.profile), why.advice()),
             now);
}

std::vector<Device> Recording::lost_ports() const {
  std::vector<Device> lost;
  if (parts_->failure || parts_->stopped || parts_->options.replug_patience_s <= 0.0) return lost;
  for (const Device device : all_devices)
    if (parts_->port_lost[device]) lost.push_back(device);
  return lost;
}

const std::vector<DeviceAbsence>& Recording::absences() const {
  return parts_->absences;
}

}  // namespace thermorig::rig
