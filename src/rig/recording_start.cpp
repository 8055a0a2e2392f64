// SPDX-License-Identifier: MIT
#include "recording_start.h"

#include <fmt/format.h>

#include <array>
#include <random>

#include "thermorig/io/host.h"
#include "thermorig/io/port.h"
#include "thermorig/rig/detect.h"
#include "thermorig/rig/profile_file.h"
#include "thermorig/sensors/device_stream.h"

namespace thermorig::rig {

namespace {

// RFC 4122, section 4.4.
std::string random_uuid() {
  std::random_device device;
  std::array<std::uint32_t, 4> words{};
  for (std::uint32_t& word : words) word = device();
  words[1] = (words[1] & 0xFFFF0FFFU) | 0x00004000U;
  words[2] = (words[2] & 0x3FFFFFFFU) | 0x80000000U;
  return fmt::format("{:08x}-{:04x}-{:04x}-{:04x}-{:04x}{:08x}", words[0], words[1] >> 16U,
                     words[1] & 0xFFFFU, words[2] >> 16U, words[2] & 0xFFFFU, words[3]);
}

/// In virtual time the first second of a recording is dated with the wall's clock.
std::int64_t realtime_offset_ns(const RecordingOptions& options, HostTime now) {
  const std::int64_t offset_ns = io::realtime_offset_ns();
  return options.virtual_time ? offset_ns + to_ns(io::now()) - to_ns(now) : offset_ns;
}

std::string what_it_sends(Device device) {
  constexpr std::array<const char*, device_count> names{"camera frames", "gyro samples",
                                                        "messages of the servo link"};
  return names[index_of(device)];
}

Error other_role(Device device, const Evidence& evidence, ExitCode code, const std::string& where) {
  return {code,
          fmt::format("it sends {}: that is the {}, not the {}", evidence.text, name_of(*evidence.role),
                      name_of(device)),
          where, "`thermorig ports` finds the right port of each device"};
}

Error other_protocol(Device device, const Evidence& evidence, std::string_view expected,
                     const std::string& where) {
  return {ExitCode::device_missing,
          fmt::format("it sends {}, where the rig profile expects {}", evidence.text, expected), where,
          fmt::format("say protocol = \"{}\" in the [{}] section of the rig profile{}; "
                      "`thermorig ports --save NAME` writes one",
                      evidence.protocol, name_of(device),
                      evidence.text_format ? ", and which columns hold the rates" : "")};
}

}  // namespace

RecordingHeader make_header(const RecordingOptions& options, HostTime now) {
  RecordingHeader header;
  header.uuid = random_uuid();
  header.environment = options.environment;
  header.title = options.title;
  header.licence = options.licence;
  header.time_reference = now;
  header.realtime_offset_ns = realtime_offset_ns(options, now);
  header.start_time_utc = io::utc_text(now, header.realtime_offset_ns);
  header.simulated = options.simulated;
  header.simulation_seed = options.simulation_seed;
  header.simulation = options.simulation;
  header.profile = options.profile;
  header.plan_name = options.plan.name;
  header.plan_toml = to_toml(options.plan);
  header.frames_per_leg = options.plan.frames_per_leg;
  header.live_model = options.live_model;
  header.estimators = options.estimators;
  header.creator = options.creator;
  header.creator_git = options.creator_git;
  header.host_name = io::host_name();
  header.kernel = io::kernel_release();
  return header;
}

std::string place_of(Device device, const RigProfile& profile) {
  const std::string& port = profile.link(device).port;
  return port.empty() ? std::string(name_of(device)) : fmt::format("{} ({})", name_of(device), port);
}

Error silent_device(Device device, const RigProfile& profile, const wire::Counters& counters,
                    std::span<const std::uint8_t> first_bytes) {
  const PortProfile& link = profile.link(device);
  const std::string where = place_of(device, profile);
  if (counters.bytes_received == 0)
    return {ExitCode::device_missing,
            device == Device::servo ? "it does not answer hello" : "it sends nothing", where,
            "check power and cable; `thermorig ports` shows which port speaks"};
  const Evidence evidence = classify(first_bytes);
  if (evidence.role && *evidence.role != device)
    return other_role(device, evidence, ExitCode::device_missing, where);
  const sensors::DeviceStream expected = sensors::device_stream(device, profile);
  if (evidence.role == device && evidence.protocol != expected.protocol)
    return other_protocol(device, evidence, expected.sends, where);
  if (evidence.role == device && evidence.messages == 0)
    return {ExitCode::device_missing, "it sends " + evidence.text, where,
            fmt::format("set the device to send {}", what_it_sends(device))};
  return {ExitCode::device_missing,
          fmt::format("it sends {} bytes, but no {} in them", counters.bytes_received, what_it_sends(device)),
          where,
          fmt::format("check the baud rate ({} now) and the device; `thermorig ports` tries the usual ones",
                      link.baud)};
}

Error unreadable_device(Device device, const RigProfile& profile, const Unreadable& unreadable,
                        std::span<const std::uint8_t> first_bytes) {
  const std::string where = place_of(device, profile);
  const Evidence evidence = classify(first_bytes);
  if (evidence.role && *evidence.role != device)
    return other_role(device, evidence, ExitCode::device_lost, where);
  return {
      ExitCode::device_lost,
      fmt::format("for {:.1f} s it has sent {} bytes, but no {} in them", unreadable.span_s, unreadable.bytes,
                  what_it_sends(device)),
      where,
      fmt::format("something changed its baud rate ({} is expected), or it hangs: unplug it and plug it in "
                  "again",
                  profile.link(device).baud)};
}

}  // namespace thermorig::rig
