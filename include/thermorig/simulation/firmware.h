// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "thermorig/simulation/world.h"

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
/// The firmware's sources compiled for the host, the AVR image in simavr, or a servo that is driven over its
/// bus.
class Firmware {
 public:
  virtual ~Firmware() = default;

  /// One byte arrives whole at `time_us` (end of its stop bit), not before the last run_until().
  virtual void receive(std::uint8_t byte, std::int64_t time_us) = 0;

  /// What an AS5600 on its I2C shows from now on. Never called: there is none.
  virtual void sense(const SensorRegisters& /*registers*/) {}

  /// Runs to `time_us` after reset.
  virtual FirmwareOutput run_until(std::int64_t time_us) = 0;

  /// A program has opened its port at `time_us`.
  virtual void opened(std::int64_t time_us) { static_cast<void>(time_us); }

  /// Where its own motor has the shaft at `time_us`, of the last half second up to the last run_until().
  /// None: it puts out pulses, and another thing turns the shaft by them.
  virtual std::optional<double> shaft_deg(double time_us) const {
    static_cast<void>(time_us);
    return std::nullopt;
  }

  /// "host build" or "AVR image": goes into the session's attributes.
  virtual std::string description() const = 0;
};

/// The sources of firmware_servo compiled for the host: deterministic, in process.
std::unique_ptr<Firmware> make_host_firmware();

/// How a simulated Dynamixel is found, and its worst habits.
struct DynamixelHabits {
  std::uint8_t return_delay = 250;  // in its EEPROM, 2 us each, as it is sold
  std::uint8_t operating_mode = 3;  // likewise
  bool echoes = false;              // its half-duplex adapter sends back what the host sends
  bool has_watchdog = true;
  double encoder_error_deg = 0.15;  // once a turn
};

/// A servo of the X series with this ID, at this baud rate: source protocols/dynamixel.md. Its firmware, its
/// motor and the shaft.
std::unique_ptr<Firmware> make_dynamixel(std::uint8_t id, std::uint32_t baud, std::uint64_t seed,
                                         const DynamixelHabits& habits = {}, const ServoWorld& world = {});

/// How a simulated GRBL board is set, and its worst habits.
struct GrblHabits {
  double max_rate_dps = 300.0;        // $110
  double acceleration_dps2 = 2000.0;  // $120
  double clock_error = 0.003;         // of its resonator, as a share
  double steps_error = 0.0;           // of $100, as a share of what motor and gear have
  bool resets_on_open = true;         // of its port, as an Arduino does
  bool is_locked = false;             // after each reset, until $X
};

/// A stepper behind GRBL 1.1, whose first axis turns: source protocols/grbl.md.
std::unique_ptr<Firmware> make_grbl(std::uint32_t baud, std::uint64_t seed, const GrblHabits& habits = {},
                                    const ServoWorld& world = {});

/// How a simulated STS3215 is found, and its worst habits.
struct Sts3215Habits {
  std::uint8_t return_delay = 250;  // in its EEPROM, 2 us each
  bool answers_writes = true;       // likewise
  bool counts_turns = false;        // likewise: as it is sold it turns within one turn
  std::uint8_t model = 9;           // of the STS; another one is a servo that only answers alike
  bool echoes = false;              // its half-duplex adapter sends back what the host sends
  bool complains = false;           // of its supply, in each answer, and turns all the same
  double play_deg = 1.0;            // of its gear
  double unevenness = 0.03;         // of its speed, as a share, from least to most
  double encoder_error_deg = 0.2;   // once a turn
};

/// Feetech's STS3215 with this ID, at this baud rate: source protocols/sts3215.md. Likewise.
std::unique_ptr<Firmware> make_sts3215(std::uint8_t id, std::uint32_t baud, std::uint64_t seed,
                                       const Sts3215Habits& habits = {}, const ServoWorld& world = {});

}  // namespace thermorig::simulation
