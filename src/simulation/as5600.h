// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>

#include "random.h"
#include "shaft.h"
#include "thermorig/simulation/firmware.h"
#include "thermorig/simulation/world.h"

namespace thermorig::simulation {

/// An AS5600 under a magnet that was glued to the shaft by hand.
///
/// Its angle is that of the shaft (or the other way round, as the board was mounted) from a zero of its own,
/// with an error once a turn by a magnet off the axis and one twice a turn by its tilt. It lags by half of
/// what its slow filter takes to settle, and has the noise of that filter: ams' data sheet AS5600, v1-06,
/// "Slow filter": 2.2 ms and 0.015 deg as it comes, 0.286 ms and 0.043 deg at the fastest.
class As5600 {
 public:
  As5600(const EncoderWorld& world, std::uint64_t seed);

  /// What its registers hold by the newest of the shaft that is known; read once, for noise and faults are
  /// drawn anew.
  SensorRegisters look(const Shaft& shaft);

  /// What the micro-controller wrote to it.
  void take(std::span<const RegisterWrite> writes);

 private:
  double measured_deg(double shaft_deg) const;

  EncoderWorld world_;
  Random random_;
  bool reversed_;
  double zero_deg_;
  double once_phase_rad_, twice_phase_rad_;
  std::uint8_t gain_;
  unsigned slow_filter_ = 0;  // CONF, SF
};

}  // namespace thermorig::simulation
