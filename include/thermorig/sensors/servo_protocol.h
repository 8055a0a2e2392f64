// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "thermorig/core/clock_properties.h"
#include "thermorig/sensors/evidence.h"
#include "thermorig/sensors/scanner.h"
#include "thermorig/sensors/wire/servo_messages.h"

namespace thermorig::sensors {

using ServoScanner = Scanner<wire::ServoMessage>;

/// What the program knows of the servo's protocol beside its commands (wire/servo_messages.h): there is one,
/// that of our own firmware.
struct ServoProtocol {
  std::string_view name;
  std::string_view sends;  // in words, many of them
  std::span<const UsualBaud> bauds;
  ClockProperties clock;
  std::uint64_t message_bytes;    // of one telemetry message, at most
  double rate_hz;                 // telemetry messages a second
  std::string_view shaft_sensor;  // what measures the shaft where its messages have ShaftReadings
  // How far its angles are off by errors that repeat with each turn, root mean square, as its maker states.
  // None: that depends on how it was put together, and has to be calibrated (EncoderProfile).
  std::optional<double> shaft_error_deg;

  ServoScanner (*scanner)();
  /// Nothing if the bytes hold fewer than two of its messages.
  std::optional<Evidence> (*recognise)(std::span<const std::uint8_t> bytes);
  std::vector<std::uint8_t> (*greeting)();         // it answers this, whatever it was doing
  std::vector<std::uint8_t> (*emergency_bytes)();  // stop it, whatever it was doing
};

const ServoProtocol& servo_protocol();

}  // namespace thermorig::sensors
