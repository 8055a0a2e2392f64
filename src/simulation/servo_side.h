// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "clock_wander.h"
#include "thermorig/simulation/firmware.h"
#include "usb_link.h"

namespace thermorig::simulation {

/// The micro-controller's clock: a crystal that is some parts per million off, and wanders by a few; or a
/// ceramic resonator, which is worse.
class McuClock {
 public:
  explicit McuClock(std::uint64_t seed, const ServoClockWorld& world = {});
  std::int64_t us_at(std::int64_t rig_ns);
  std::int64_t rig_ns_at(double us);

 private:
  double us_per_ns_;
  ClockWander wander_;
};

/// The servo's micro-controller on its own clock and serial line.
class ServoSide {
 public:
  ServoSide(std::unique_ptr<Firmware> firmware, std::uint32_t baud, std::uint64_t seed,
            const World& world = {});

  /// Bytes that begin on the line toward the micro-controller at rig time `begin_ns`, or when it is free.
  void send(std::span<const std::uint8_t> bytes, std::int64_t begin_ns);

  /// What a sensor on the micro-controller's I2C shows from now on.
  void sense(const SensorRegisters& registers) { firmware_->sense(registers); }

  struct Output {
    std::vector<TimedByte> bytes;   // rig time
    std::vector<PulseEdge> pulses;  // micro-controller time
    std::vector<RegisterWrite> writes;
  };
  /// Runs the firmware to rig time `until_ns`, with every byte at its own time.
  Output run_until(std::int64_t until_ns);

  std::int64_t end_ns(const PulseEdge& pulse) {
    return clock_.rig_ns_at(static_cast<double>(pulse.rise_us) + pulse.width_us);
  }

  void opened(std::int64_t rig_ns) { firmware_->opened(clock_.us_at(rig_ns)); }

  /// See Firmware::shaft_deg(). Not beyond the last run_until().
  std::optional<double> shaft_deg(std::int64_t rig_ns) {
    return firmware_->shaft_deg(static_cast<double>(clock_.us_at(rig_ns)));
  }

  McuClock& clock() { return clock_; }

 private:
  void run_firmware(std::int64_t mcu_us, Output& out);

  std::unique_ptr<Firmware> firmware_;
  McuClock clock_;
  UartLine toward_;
  std::int64_t byte_ns_;
  bool is_off_baud_;  // bytes take another time than the firmware believes
  std::int64_t last_byte_ns_ = 0;
  std::vector<TimedByte> sending_;
  std::deque<TimedByte> coming_;
};

}  // namespace thermorig::simulation
