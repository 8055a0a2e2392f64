// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "thermorig/core/device.h"
#include "thermorig/core/error.h"
#include "thermorig/core/profile.h"
#include "thermorig/rig/discovery/port_loop.h"
#include "thermorig/sensors/evidence.h"

namespace thermorig::rig {

/// What some bytes look like. Pure: no port, no clock.
struct Evidence {
  std::optional<Device> role;
  std::string protocol;          // of that role: a name of its table in sensors
  double explained_share = 0.0;  // share of the bytes that lie in its good messages, 0..1
  sensors::Evidence found;       // its text and, where the bytes cannot be recorded, its advice
};

/// Which device sends such bytes? At least two good messages (one camera frame) that hold most of the bytes.
/// What cannot be recorded has no role, but a text and an advice. `heard_s`: how long the bytes took to come,
/// 0 if that is not known; it tells the unit of a text gyro's clock.
Evidence classify(std::span<const std::uint8_t> bytes, double heard_s = 0.0);

/// What was found on one port.
struct PortFinding {
  io::PortInfo info;
  std::optional<Device> role;
  std::uint32_t baud = 0;        // at which it spoke; 0 for a pseudo terminal
  std::string protocol;          // of that role: a name of its table in sensors
  std::string how;               // evidence, ready to print; or "silent at 7 baud rates"
  std::string problem;           // could not be opened: why; else empty
  ExitCode code = ExitCode::ok;  // of that problem
  std::string advice;            // what it sends cannot be recorded: what to try; else empty
  double rate_hz = 0.0;          // messages a second while it spoke
  std::optional<sensors::TextFormat> text_format;  // of a text gyro
  std::optional<int> axis;                         // of x, y, z: the gyro's that a hand has turned
  std::map<std::string, double> settings;          // of a gyro's protocol, which its bytes tell

  /// Nothing of how it is read is a guess.
  bool is_known() const { return !text_format || text_format->is_known(); }
};

/// Listens on all ports at once, at the usual bauds one after another; what is still unknown then is greeted
/// as a servo board. Within `listen_s` seconds; where nothing was found, other servos are asked for, too,
/// which takes two thirds longer. A pty has no baud: it is listened to once. Throws Error(interrupted) when a
/// signal asks it to stop.
std::vector<PortFinding> identify_devices(const std::vector<io::PortInfo>& ports, double listen_s = 6.0);

/// The same on the ports and the clock of `loop`, which serves nothing else, and is not run again after it.
std::vector<PortFinding> identify_devices(const std::vector<io::PortInfo>& ports, PortLoop& loop,
                                          double listen_s = 6.0);

/// How long a turn by hand is listened to.
constexpr double hand_turn_s = 8.0;

/// Listens to a text gyro, of which its lines say too little, while it is turned by hand
/// (sensors/hand_turn.h): its finding, in which nothing is a guess any more. Nothing if the turn did not show
/// it. Throws Error(interrupted), as identify_devices() does.
std::optional<PortFinding> hear_hand_turn(PortFinding finding, PortLoop& loop);

/// The profile with the ports, bauds, protocols and rates that were found. The columns of a text gyro are
/// taken where its lines say what they are and the profile had no text gyro before; columns that a person has
/// set stay. A gyro whose lines do not say it is left out, unless the profile knows them. Roles found twice
/// are left alone and reported through `ambiguous` (one sentence each).
RigProfile apply_findings(RigProfile profile, const std::vector<PortFinding>& findings,
                          std::vector<std::string>& ambiguous);

}  // namespace thermorig::rig
