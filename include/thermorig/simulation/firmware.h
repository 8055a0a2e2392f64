// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace thermorig::simulation {

/// A byte that the micro-controller put on its UART, with its own time.
struct UartByte {
  std::int64_t time_us = 0;  // when its start bit began
  std::uint8_t value = 0;
};

/// A pulse on the servo pin, with the micro-controller's time.
struct PulseEdge {
  std::int64_t rise_us = 0;
  double width_us = 0.0;
};

/// What the firmware did since the last call.
struct FirmwareOutput {
  std::vector<UartByte> bytes;
  std::vector<PulseEdge> pulses;  // in the order in which they ended
};

/// The servo's micro-controller, advanced in lock step: its time moves only in run_until().
/// Two implementations: the firmware's sources compiled for the host, and the AVR image in simavr.
class Firmware {
 public:
  virtual ~Firmware() = default;

  /// One byte arrives whole at `time_us` (end of its stop bit), not before the last run_until().
  virtual void receive(std::uint8_t byte, std::int64_t time_us) = 0;

  /// Runs to `time_us` after reset.
  virtual FirmwareOutput run_until(std::int64_t time_us) = 0;

  /// "host build" or "AVR image": goes into the session's attributes.
  virtual std::string description() const = 0;
};

/// The sources of firmware_servo compiled for the host: deterministic, in process.
std::unique_ptr<Firmware> make_host_firmware();

}  // namespace thermorig::simulation
