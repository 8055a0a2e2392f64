// SPDX-License-Identifier: MIT
#pragma once

namespace thermorig::wire {

/// Whether the supply of the servo's board broke down: `reset_cause` is the AVR's MCUSR (WELCOME). Switching
/// the supply on passes through the brown-out voltage as well, and sets both bits.
inline bool was_brown_out(unsigned reset_cause) {
  constexpr unsigned power_on = 1U << 0U;   // PORF
  constexpr unsigned brown_out = 1U << 2U;  // BORF
  return (reset_cause & brown_out) != 0 && (reset_cause & power_on) == 0;
}

}  // namespace thermorig::wire
