// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "thermorig/core/clock_properties.h"
#include "thermorig/core/profile.h"
#include "thermorig/sensors/evidence.h"
#include "thermorig/sensors/scanner.h"
#include "thermorig/sensors/wire/servo_messages.h"

namespace thermorig::sensors {

using ServoScanner = Scanner<wire::ServoMessage>;

/// Why a shaft turns by another angle than was commanded, and what to change; ready to print.
struct ScaleCause {
  std::string why, remedy;
};

/// What the program knows of a servo's protocol beside how it is driven (rig/sweep/servo_driver.h).
struct ServoProtocol {
  std::string_view name;        // in profiles, sessions and `decode --servo-protocol`
  std::string_view sends;       // in words, many of them
  std::string_view greeted_as;  // what it answers first: "hello"
  std::span<const UsualBaud> bauds;
  bool is_silent;  // until it is asked: who speaks unasked at such a baud rate is another device
  ClockProperties clock;
  std::uint64_t message_bytes;    // of one telemetry message, at most
  double rate_hz;                 // telemetry messages a second
  double longest_gap_s;           // between two of them; more is a loss
  std::string_view shaft_sensor;  // what measures the shaft where its messages have ShaftReadings
  // How far its angles are off by errors that repeat with each turn, root mean square, as its maker states.
  // None: that depends on how it was put together, and has to be calibrated (EncoderProfile).
  std::optional<double> shaft_error_deg;

  /// Its sent() takes what is written to the servo, without which some answers cannot be understood.
  ServoScanner (*scanner)(const ServoProfile& profile);
  /// Nothing if the bytes hold too few of its messages.
  std::optional<Evidence> (*recognise)(std::span<const std::uint8_t> bytes);
  std::vector<std::uint8_t> (*greeting)();  // it answers this, whatever it was doing, and moves nothing
  std::vector<std::uint8_t> (*emergency_bytes)();  // stop it, whatever it was doing

  /// Its angles are steps that it has put out: over seconds they show how fast its clock goes, which also
  /// makes the speeds that it states.
  bool counts_steps = false;
  /// What asks for one telemetry message, and for nothing else, which holds for the instant of the request.
  /// None: it comes by itself, or holds for another instant.
  std::vector<std::uint8_t> (*telemetry_request)(const ServoProfile& profile) = nullptr;
  /// Where the shaft turned by `share` of what was commanded, and a setting of the servo may be the cause. By
  /// what it has answered. None: no setting is known.
  std::optional<ScaleCause> (*scale_cause)(double share,
                                           std::span<const wire::ServoMessage> answers) = nullptr;
};

/// The table. The first one is what a profile has that names none.
std::span<const ServoProtocol> servo_protocols();

std::vector<std::string> servo_protocol_names();

/// Nothing if there is none of that name.
const ServoProtocol* find_servo_protocol(std::string_view name);

/// Throws Error(bad_usage) if there is none of that name: it lists those there are.
const ServoProtocol& servo_protocol(std::string_view name);

/// Takes the protocol, and what goes with it where the profile still says what another one has: its usual
/// baud. Throws as servo_protocol() does.
void choose_servo(std::string_view protocol, ServoProfile& profile);

}  // namespace thermorig::sensors
