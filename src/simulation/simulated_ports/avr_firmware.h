// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "thermorig/simulation/firmware.h"

namespace thermorig {

/// The AVR image of the servo firmware in simavr, a process of its own (thermorig-avr), in lock step. Looks
/// for `thermorig-avr` and `servo_firmware.hex` in $THERMORIG_LIBEXEC where that is set, else beside this
/// executable (a build folder), else where `cmake --install` puts them; nullptr where either is missing. Its
/// calls throw Error (failed) where that process dies. Ends with the object.
std::unique_ptr<simulation::Firmware> make_avr_firmware();

}  // namespace thermorig
