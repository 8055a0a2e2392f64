// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "thermorig/simulation/simulated_ports/simulated_ports.h"

namespace thermorig::tests {

/// A byte that the micro-controller received, and when in its own time.
struct ReceivedByte {
  std::int64_t time_us = 0;
  std::uint8_t value = 0;
};

/// What a look at the micro-controller's pins shows. `now_us` may be read at any time, the lists once
/// the ports have stopped.
struct ServoDecoder {
  std::atomic<std::int64_t> now_us = 0;
  std::atomic<std::int64_t> turned_us = 0;  // when a pulse last differed from the one before it
  std::vector<ReceivedByte> received;
  std::vector<simulation::PulseEdge> pulses;  // on the servo pin
};

/// A simulated rig on three ports in this process, the AVR image in its servo where it is built. Keeps what
/// the rig did in truth.
class ServedRig {
 public:
  ServedRig(std::uint64_t seed, const std::string& environment);

  /// Writes a profile of the ports, for `--rig`.
  void write_profile(const std::filesystem::path& path) const;

  /// Lets the micro-controller live for so long.
  void let_pass(std::int64_t mcu_us) const;

  const RigProfile& profile() const { return config_.profile; }

  SimulatedPorts& ports() { return *ports_; }
  const SimulatedPorts& ports() const { return *ports_; }
  const ServoDecoder& line() const { return *line_; }

  // After ports().stop().
  std::int64_t last_byte_us() const { return line_->received.back().time_us; }
  /// The shaft's largest speed, whatever its sign, from one to another time of the micro-controller, whose
  /// crystal is good for a millisecond in these tests.
  double fastest_dps(std::int64_t from_us, std::int64_t to_us) const;
  /// When it last turned that fast, up to then; 0 if never.
  std::int64_t last_motion_us(double rate_dps,
                              std::int64_t until_us = std::numeric_limits<std::int64_t>::max()) const;

 private:
  simulation::VirtualRigConfig config_;
  std::shared_ptr<ServoDecoder> line_;
  std::unique_ptr<SimulatedPorts> ports_;
};

}  // namespace thermorig::tests
