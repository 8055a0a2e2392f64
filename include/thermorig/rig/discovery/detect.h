// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "thermorig/core/device.h"
#include "thermorig/core/error.h"
#include "thermorig/core/profile.h"
#include "thermorig/rig/discovery/port_loop.h"
#include "thermorig/sensors/text_format.h"

namespace thermorig::rig {

/// What some bytes look like. Pure: no port, no clock.
struct Evidence {
  std::optional<Device> role;
  std::string protocol;                            // of that role: a name of its table in sensors
  std::uint64_t messages = 0;                      // good messages of that role
  double explained_share = 0.0;                    // share of the bytes that lie in them, 0..1
  std::string text;                                // "12 camera frames (GY-MCU90640), checksums good"
  std::optional<sensors::TextFormat> text_format;  // of a text gyro
};

/// Which device sends such bytes? At least two good messages (one camera frame) that hold most of the bytes.
/// `heard_s`: how long they took to come, 0 if that is not known; it tells the unit of a text gyro's clock.
Evidence classify(std::span<const std::uint8_t> bytes, double heard_s = 0.0);

/// What was found on one port.
struct PortFinding {
  io::PortInfo info;
  std::optional<Device> role;
  std::uint32_t baud = 0;                          // at which it spoke; 0 for a pseudo terminal
  std::string protocol;                            // of that role: a name of its table in sensors
  std::string how;                                 // evidence, ready to print; or "silent at 7 baud rates"
  std::string problem;                             // could not be opened: why; else empty
  ExitCode code = ExitCode::ok;                    // of that problem
  double rate_hz = 0.0;                            // messages a second while listening
  std::optional<sensors::TextFormat> text_format;  // of a text gyro: its columns are a guess
};

/// Listens on all ports at once, at the usual bauds one after another; what is still unknown then is greeted
/// as a servo. Within `listen_s` seconds. A pty has no baud: it is listened to once.
std::vector<PortFinding> identify_devices(const std::vector<io::PortInfo>& ports, double listen_s = 6.0);

/// The same on the ports and the clock of `loop`, which serves nothing else, and is not run again after it.
std::vector<PortFinding> identify_devices(const std::vector<io::PortInfo>& ports, PortLoop& loop,
                                          double listen_s = 6.0);

/// The profile with the ports, bauds and protocols that were found. The guessed columns of a text gyro
/// are taken where the profile had no text gyro before; columns that a person has set stay. Roles found twice
/// are left alone and reported through `ambiguous` (one sentence each).
RigProfile apply_findings(RigProfile profile, const std::vector<PortFinding>& findings,
                          std::vector<std::string>& ambiguous);

}  // namespace thermorig::rig
