// SPDX-License-Identifier: MIT
#include "recording_start.h"

#include <fmt/format.h>

#include <array>
#include <random>

#include "thermorig/io/host.h"
#include "thermorig/io/port.h"
#include "thermorig/rig/detect.h"
#include "thermorig/rig/profile_file.h"
#include "thermorig/wire/device_bytes.h"

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

std::string what_is_sent(Device device) {
  constexpr std::array<const char*, device_count> names{"camera frames", "gyro samples",
                                                        "messages of the servo link"};
  return names[index_of(device)];
}

}  // namespace

RecordingHeader make_header(const RecordingOptions& options, HostTime now) {
  RecordingHeader header;
  header.uuid = random_uuid();
  header.environment = options.environment;
  header.title = options.title;
  header.time_reference = now;
  header.realtime_offset_ns = realtime_offset_ns(options, now);
  header.start_time_utc = io::utc_text(now, header.realtime_offset_ns);
  header.simulated = options.simulated;
  header.simulation_seed = options.simulation_seed;
  header.simulation = options.simulation;
  header.profile = options.profile;
  header.profile_toml = profile_text(options.profile);
  header.plan_name = options.plan.name;
  header.plan_toml = to_toml(options.plan);
  header.frames_per_leg = options.plan.frames_per_leg;
  header.creator = options.creator;
  header.creator_git = options.creator_git;
  header.host_name = io::host_name();
  header.kernel = io::kernel_release();
  return header;
}

std::uint64_t expected_journal_bytes(const RecordingOptions& options) {
  const RigProfile& profile = options.profile;
  constexpr double per_chunk = 40.0;           // the journal's own bytes
  constexpr double gyro_message_bytes = 64.0;  // the longest usual line; packets are shorter
  constexpr double servo_bytes_per_s = 100.0 * 30.0 + 30.0 * 12.0;
  const double bytes_per_s = profile.camera.output_rate_hz * (wire::camera_frame_bytes + 50.0 * per_chunk) +
                             profile.gyro.output_rate_hz * (gyro_message_bytes + per_chunk) +
                             servo_bytes_per_s + 200.0 * per_chunk;
  const double duration_s = plan_duration_s(options.plan, profile.servo, profile.camera.output_rate_hz);
  return static_cast<std::uint64_t>(bytes_per_s * (1.2 * duration_s + 10.0));
}

Error silent_device(Device device, const PortProfile& link, const wire::Counters& counters,
                    std::span<const std::uint8_t> first_bytes) {
  const std::string where =
      link.port.empty() ? std::string(name_of(device)) : fmt::format("{} ({})", name_of(device), link.port);
  if (counters.bytes_received == 0)
    return {ExitCode::device_missing,
            device == Device::servo ? "it does not answer hello" : "it sends nothing", where,
            "check power and cable; `thermorig ports` shows which port speaks"};
  const Evidence evidence = classify(first_bytes);
  if (evidence.role && *evidence.role != device)
    return {ExitCode::device_missing,
            fmt::format("it sends {}: that is the {}, not the {}", evidence.text, name_of(*evidence.role),
                        name_of(device)),
            where, "`thermorig ports` finds the right port of each device"};
  return {ExitCode::device_missing,
          fmt::format("it sends {} bytes, but no {} in them", counters.bytes_received, what_is_sent(device)),
          where,
          fmt::format("check the baud rate ({} now) and the device; `thermorig ports` tries the usual ones",
                      link.baud)};
}

}  // namespace thermorig::rig
