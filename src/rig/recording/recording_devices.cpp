// SPDX-License-Identifier: MIT
// Devices of a recording that go: what ends it, what it waits for, and what it does without.
#include <fmt/format.h>

#include <algorithm>

#include "recording_parts.h"
#include "thermorig/sensors/wire/servo_messages.h"

namespace thermorig::rig {

void Recording::Parts::fail(const Error& error, HostTime now) {
  const bool first = !end.failure;
  if (first) {
    end.failure = error;
    event({now, EventKind::device_lost, std::nullopt, error.where() + ": " + error.what_happened()});
  }
  // A servo that does not answer cannot be stopped from here; it comes to rest by itself (ServoDriver).
  if (!first || sweep.phase() == SweepPhase::stopping || presence[Device::servo].is_awaited())
    end.servo_is_gone = true;
  if (!end.servo_is_gone) sweep.request_stop(now);
}

/// A device is not there, or no more: the end, or an event where the recording can do without it.
void Recording::Parts::lose(Device device, const Error& error, HostTime now, bool has_port) {
  DevicePresence& gone = presence[device];
  const bool loses_port = gone.has_port() && !has_port;
  if (!has_port) gone.lose_port();
  if (gone.is_awaited()) return loses_port ? lose_port_again(device, error, now) : void();
  if (gone.is_done_without()) return;
  const bool is_needed = device == Device::servo || options.needed[device];
  if (device != Device::servo && sweep.phase() == SweepPhase::halting && !end.is_coming()) {
    gone.forgo();
    return event({now, EventKind::warning, device,
                  fmt::format("{}: {}, after the plan's last frame", error.where(), error.what_happened())});
  }
  const bool all_gone =
      presence[Device::camera].is_done_without() || presence[Device::gyro].is_done_without();
  if (is_needed || all_gone) {
    if (waits()) return await(device, error, now);
    if (device == Device::servo) end.servo_is_gone = devices.has_spoken(device) || !has_port;
    return fail(error, now);
  }
  interrupt(device, now);
  if (gone_advice.empty()) gone_advice = error.advice();
  gone.do_without();
  if (device == Device::camera) pipeline.stand_in_for_camera(now);
  event({now, EventKind::missing, device,
         fmt::format("{}: {}; going on without it", error.where(), error.what_happened())});
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
  return options.replug_patience_s > 0.0 && start.was_ready() && !end.is_coming() &&
         sweep.phase() != SweepPhase::halting && sweep.phase() != SweepPhase::stopping && !sweep.done();
}

void Recording::Parts::await(Device device, const Error& error, HostTime now) {
  event({now, EventKind::device_lost, device,
         fmt::format("{}: {}; waiting up to {:.0f} s for it", error.where(), error.what_happened(),
                     options.replug_patience_s)});
  interrupt(device, now);
  presence[device].await(error, now);
  sweep.suspend(now, error);
  if (device == Device::servo) commander.greet();  // all that it was told is forgotten, and so is what waits
}

/// It was open once more, and is gone again: what it sent then was a stream of its own.
void Recording::Parts::lose_port_again(Device device, const Error& error, HostTime now) {
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

bool Recording::Parts::awaits_any() const {
  return std::any_of(all_devices.begin(), all_devices.end(),
                     [this](Device device) { return presence[device].is_awaited(); });
}

void Recording::Parts::look_for_returns(HostTime now) {
  if (!awaits_any() || end.is_coming()) return;
  for (const Device device : all_devices) {
    const bool answers = device != Device::servo || (commander.greeted() && commander.idle());
    if (answers && presence[device].is_awaited() && presence[device].is_back()) note_back(device, now);
  }
  if (!awaits_any()) {
    start.listen_anew(now, counts());
    return sweep.go_on(now);
  }
  for (const DevicePresence& one : presence.values)
    if (const auto verdict = one.verdict(now)) return fail(*verdict, now);
}

void Recording::Parts::note_back(Device device, HostTime now) {
  const HostTime since = presence[device].come_back();
  absences.push_back({device, since, now});
  event({now, EventKind::device_back, device,
         fmt::format("{}: it is back after {:.1f} s; its clock starts again",
                     place_of(device, options.profile), to_s(now - since))});
}

void Recording::returned(Device device, HostTime now) {
  Parts& parts = *parts_;
  parts.requests.port_opened(device);
  parts.presence[device].open_port(now);
}

void Recording::refused(Device device, const Error& why, HostTime now) {
  Parts& parts = *parts_;
  if (parts.end.is_coming()) return;
  if (parts.presence[device].is_done_without())
    parts.event({now, EventKind::warning, device,
                 fmt::format("{}: it is back, but {}; going on without it",
                             place_of(device, parts.options.profile), why.what_happened())});
  if (!parts.presence[device].is_awaited()) return;
  parts.fail(Error(why.code(), "it is back, but " + why.what_happened(),
                   place_of(device, parts.options.profile), why.advice()),
             now);
}

std::vector<Device> Recording::lost_ports() const {
  std::vector<Device> lost;
  if (parts_->end.is_coming() || parts_->options.replug_patience_s <= 0.0) return lost;
  for (const Device device : all_devices)
    if (parts_->options.profile.has(device) && !parts_->presence[device].has_port()) lost.push_back(device);
  return lost;
}

}  // namespace thermorig::rig
