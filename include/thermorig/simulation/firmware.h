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

enum class SensorBus : std::uint8_t { answers, silent, hangs_high };

/// Registers of an AS5600 on the micro-controller's I2C, as it reads them, and what the bus makes of that:
/// `silent` acknowledges nothing, `hangs_high` gives ones for what is read.
struct SensorRegisters {
  SensorBus bus = SensorBus::answers;
  std::uint8_t status = 0;  // 0x0B
  std::uint16_t raw = 0;    // 0x0C, 0x0D
  std::uint8_t gain = 0;    // 0x1A
};

/// The byte of such a register.
std::uint8_t register_byte(const SensorRegisters& registers, std::uint8_t address);

/// What the firmware wrote to that sensor.
struct RegisterWrite {
  std::uint8_t address = 0;
  std::uint8_t value = 0;
};

/// What the firmware did since the last call.
struct FirmwareOutput {
  std::vector<UartByte> bytes;
  std::vector<PulseEdge> pulses;  // in the order in which they ended
  std::vector<RegisterWrite> writes;
};

/// The servo's micro-controller, advanced in lock step: its time moves only in run_until().
/// Two implementations: the firmware's sources compiled for the host, and the AVR image in simavr.
class Firmware {
 public:
  virtual ~Firmware() = default;

  /// One byte arrives whole at `time_us` (end of its stop bit), not before the last run_until().
  virtual void receive(std::uint8_t byte, std::int64_t time_us) = 0;

  /// What an AS5600 on its I2C shows from now on. Never told: there is none.
  virtual void sense(const SensorRegisters& /*registers*/) {}

  /// Runs to `time_us` after reset.
  virtual FirmwareOutput run_until(std::int64_t time_us) = 0;

  /// "host build" or "AVR image": goes into the session's attributes.
  virtual std::string description() const = 0;
};

/// The sources of firmware_servo compiled for the host: deterministic, in process.
std::unique_ptr<Firmware> make_host_firmware();

}  // namespace thermorig::simulation
