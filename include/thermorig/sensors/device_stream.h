// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "thermorig/core/clock_properties.h"
#include "thermorig/core/device.h"
#include "thermorig/core/profile.h"
#include "thermorig/sensors/camera_protocol.h"
#include "thermorig/sensors/evidence.h"

namespace thermorig::sensors {

// The tables of all roles, for those who ask of any device.

/// What a device sends, as the table and the rig's profile have it.
struct DeviceStream {
  std::string_view protocol;  // its name in the table
  std::string_view sends;     // in words, many of them
  std::uint64_t message_bytes = 0;
  double rate_hz = 0.0;  // messages a second, nominal
  ClockProperties clock;
};

/// Throws Error(bad_usage) if the profile names a protocol that the table does not have.
DeviceStream device_stream(Device device, const RigProfile& profile);

/// What makes a camera or gyro send its stream; `asked`: how often it was asked already, in vain. Empty: it
/// sends by itself.
Commands stream_request(Device device, const RigProfile& profile, unsigned asked);

/// What asks for one message more, told with each that came. Empty: it sends a stream.
std::vector<std::uint8_t> next_request(Device device, const RigProfile& profile);

/// Between two commands of a request (protocols/gy_mcu90640.md, "Commands").
inline constexpr std::chrono::milliseconds command_gap{100};

/// One that some bytes may come from.
struct Recognised {
  std::optional<Device> role;  // none: no protocol of any table reads it
  std::string_view protocol;
  Evidence evidence;

  /// It can be recorded.
  bool is_usable() const { return role && evidence.advice.empty(); }
};

/// Streams that are sound, and that no protocol of the tables reads: what they are, and what to do about it.
/// Nothing if the bytes are none of them.
std::optional<Evidence> recognise_foreign(std::span<const std::uint8_t> bytes);

/// The same of bytes that nothing else is made of: frames of a protocol that is read, but with wrong check
/// sums; and those of a layout that nobody knows, by what comes again. A guess, which explains no byte: it
/// ends no search for a baud rate.
std::optional<Evidence> recognise_unread(std::span<const std::uint8_t> bytes);

/// All that recognise the bytes, which came in `heard_s` seconds (0: not known): this is the one table that
/// ports, dumps and silent devices are judged by. What no protocol reads comes first, and excludes text.
std::vector<Recognised> recognise(std::span<const std::uint8_t> bytes, double heard_s);

/// A stretch of a search at one baud rate.
struct SearchStep {
  UsualBaud at;
  std::vector<std::uint8_t> greeting;  // to be sent again and again; empty: just listen
  bool only_if_silent = false;         // greet once nothing came for a while: who speaks is left alone
};

/// Every usual baud rate, with its largest share: those of cameras first, which are greeted where they are
/// silent, then those of gyros, at last those of servos, which have to be greeted. A rate comes again where
/// another greeting belongs to it. The shares are of the time in which cameras, gyros and our own servo board
/// are found: to find other servos takes longer.
std::vector<SearchStep> search_steps();

}  // namespace thermorig::sensors
