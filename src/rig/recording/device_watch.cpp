// SPDX-License-Identifier: MIT
#include "device_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

#include "device_presence.h"
#include "thermorig/io/files/holder.h"
#include "thermorig/rig/discovery/detect.h"
#include "thermorig/rig/sweep/plan.h"
#include "thermorig/sensors/device_stream.h"
#include "thermorig/sensors/gyro_sketch.h"

namespace thermorig::rig {

namespace {

constexpr double silence_s = 3.0;        // then a device that has spoken before counts as lost
constexpr double silent_periods = 10.0;  // or so many of its periods, if they are longer

std::string what_it_sends(Device device) {
  constexpr std::array<const char*, device_count> names{"camera frames", "gyro samples",
                                                        "messages of the servo link"};
  return names[index_of(device)];
}

Error other_role(Device device, const Evidence& evidence, ExitCode code, const std::string& where) {
  return {code,
          fmt::format("it sends {}: this is the {}, not the {}", evidence.found.text, name_of(*evidence.role),
                      name_of(device)),
          where, "`thermorig ports` finds the right port of each device"};
}

Error other_protocol(Device device, const Evidence& evidence, std::string_view expected,
                     const std::string& where) {
  return {ExitCode::device_missing,
          fmt::format("it sends {}, but the rig profile expects {}", evidence.found.text, expected), where,
          fmt::format("set protocol = \"{}\" in the [{}] section of the rig profile{}; `thermorig ports "
                      "--save NAME` writes one",
                      evidence.protocol, name_of(device),
                      evidence.found.text_format ? ", and which columns hold the rates" : "")};
}

/// "message = 27, raw_scale_dps = 0.0573".
std::string settings_text(const std::map<std::string, double>& settings) {
  std::string text;
  for (const auto& [name, value] : settings)
    text += fmt::format("{}{} = {:.4g}", text.empty() ? "" : ", ", name, value);
  return text;
}

/// Why nothing usable came from a device, from what did come.
Error silent_device(Device device, const RigProfile& profile, const FirstBytes& bytes) {
  const PortProfile& link = profile.link(device);
  const std::string where = place_of(device, profile);
  if (bytes.count() == 0)
    return {ExitCode::device_missing,
            device == Device::servo ? "it does not answer hello" : "it sends nothing", where,
            "check power and cable; `thermorig ports` shows which ports send data"};
  const Evidence evidence = classify(bytes.kept());
  if (evidence.role && *evidence.role != device)
    return other_role(device, evidence, ExitCode::device_missing, where);
  const sensors::DeviceStream expected = sensors::device_stream(device, profile);
  if (evidence.role == device && evidence.protocol != expected.protocol)
    return other_protocol(device, evidence, expected.sends, where);
  const auto id = evidence.found.settings.find("bus_id");
  if (device == Device::servo && id != evidence.found.settings.end() && id->second != profile.servo.bus_id)
    return {ExitCode::device_missing,
            fmt::format("the servo with ID {:.0f} answers, but none with ID {}", id->second,
                        profile.servo.bus_id),
            where, fmt::format("set bus_id = {:.0f} in the [servo] section of the rig profile", id->second)};
  if (!evidence.found.advice.empty())
    return {ExitCode::device_missing, "it sends " + evidence.found.text, where, evidence.found.advice};
  if (evidence.role == device && evidence.found.text_format) {
    const std::string why = sensors::contradiction(profile.gyro, *evidence.found.text_format);
    if (!why.empty())
      return {ExitCode::device_missing,
              fmt::format("{}; for example: {}", why, evidence.found.text_format->sample_line), where,
              "`thermorig ports --save NEW_NAME` writes a profile for these lines; or change the sketch"};
    return {ExitCode::device_missing,
            fmt::format("its lines do not fit [gyro.text] of the rig profile; for example: {}",
                        evidence.found.text_format->sample_line),
            where,
            "`thermorig ports --save NEW_NAME` writes a profile for these lines; or correct [gyro.text]"};
  }
  if (evidence.role == device && evidence.found.is_asked_otherwise)
    return {
        ExitCode::device_missing,
        fmt::format("it was asked for {}, but still sends {}", expected.sends, evidence.found.text), where,
        fmt::format("connect its RX wire; or record what it sends: set {} in [gyro.{}] of the rig profile",
                    settings_text(evidence.found.settings), evidence.protocol)};
  if (evidence.role == device && !evidence.found.settings.empty())
    return {ExitCode::device_missing,
            fmt::format("it sends {}, which the rig profile does not ask for", evidence.found.text), where,
            fmt::format("set {} in [gyro.{}] of the rig profile; `thermorig ports --save NEW_NAME` does that",
                        settings_text(evidence.found.settings), evidence.protocol)};
  return {ExitCode::device_missing,
          fmt::format("it sends {} bytes, but no {} in them", bytes.count(), what_it_sends(device)), where,
          fmt::format("check the baud rate ({} now) and the device; `thermorig ports` tries the usual ones",
                      link.baud)};
}

/// A device that could be read before cannot be any more: such bytes came for so long.
Error unreadable_device(Device device, const RigProfile& profile, const FirstBytes& bytes, double span_s) {
  const std::string where = place_of(device, profile);
  const Evidence evidence = classify(bytes.kept());
  if (evidence.role && *evidence.role != device)
    return other_role(device, evidence, ExitCode::device_lost, where);
  if (!evidence.found.advice.empty())
    return {ExitCode::device_lost, "it now sends " + evidence.found.text, where, evidence.found.advice};
  if (evidence.role == device && evidence.found.text_format)
    return {ExitCode::device_lost,
            fmt::format("its lines have changed: now {} columns after \"{}\", which do not fit [gyro.text]",
                        evidence.found.text_format->fields, evidence.found.text_format->columns.prefix),
            where, "make it print the same lines throughout"};
  return {ExitCode::device_lost,
          fmt::format("for {:.1f} s it has sent {} bytes, but no {} in them", span_s, bytes.count(),
                      what_it_sends(device)),
          where,
          fmt::format(
              "its baud rate may have changed ({} is expected), or it hangs: unplug it and plug it in again",
              profile.link(device).baud)};
}

/// Where another program has the port open as well, it gets the bytes that are missed.
Error with_reader(const Error& error, const std::string& port) {
  const auto reader = port.empty() ? std::nullopt : files::other_holder_of(port);
  if (!reader) return error;
  const bool is_lost = error.code() == ExitCode::device_lost;
  return {is_lost ? error.code() : ExitCode::no_permission,
          fmt::format("{}: {} has this port open as well, and takes bytes", error.what_happened(), *reader),
          error.where(), "stop that program"};
}

}  // namespace

DeviceWatch::DeviceWatch(const RigProfile& profile, double start_patience_s, HostTime begin)
    : profile_(profile), start_patience_s_(start_patience_s), begin_(begin) {}

bool DeviceWatch::frame(const TimedFrame& frame, HostTime arrived) {
  missing_frames_ += frame.missing_before;
  good(Device::camera, frame.stamp, arrived);
  return frozen_.frame(frame);
}

bool DeviceWatch::gyro(const TimedGyro& gyro, HostTime arrived) {
  good(Device::gyro, gyro.stamp, arrived);
  return frozen_.gyro(gyro);
}

bool DeviceWatch::servo(const TimedServo& servo, HostTime arrived) {
  good(Device::servo, servo.stamp, arrived);
  return frozen_.servo(servo);
}

void DeviceWatch::good(Device device, const Stamp& stamp, HostTime arrived) {
  meters_[device].message(arrived);
  first_bytes_[device].clear();
  uncertainty_s_[device] = stamp.uncertainty_s;
}

double DeviceWatch::patience_s(Device device) const {
  const double periods_s = silent_periods / link_load(device, profile_).rate_hz;
  return std::max(has_spoken(device) ? silence_s : start_patience_s_, periods_s);
}

std::optional<Error> DeviceWatch::trouble(Device device, HostTime now) const {
  if (const auto& frozen = frozen_.trouble(device))
    return Error(ExitCode::device_lost, *frozen, place_of(device, profile_),
                 "unplug it and plug it in again");
  const double silent_s = to_s(now - meters_[device].last().value_or(begin_));
  if (silent_s <= patience_s(device)) return std::nullopt;
  return with_reader(silence(device, silent_s), profile_.link(device).port);
}

Error DeviceWatch::silence(Device device, double silent_s) const {
  const FirstBytes& bytes = first_bytes_[device];
  if (!has_spoken(device)) return silent_device(device, profile_, bytes);
  if (bytes.count() > 0) return unreadable_device(device, profile_, bytes, silent_s);
  return {ExitCode::device_lost, fmt::format("it has sent nothing for {:.1f} s", silent_s),
          place_of(device, profile_), "check cable and power, then record again"};
}

DeviceHealth DeviceWatch::health(Device device, HostTime now, const wire::Counters& counters) const {
  DeviceHealth health = meters_[device].health(now, counters);
  health.expected_hz = link_load(device, profile_).rate_hz;
  health.uncertainty_s = uncertainty_s_[device];
  if (device == Device::camera) health.lost += missing_frames_;
  return health;
}

}  // namespace thermorig::rig
