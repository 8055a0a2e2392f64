// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/network/instruction_set.h"

/// Multiply-adds on numbers that never leave the registers, as many at a time as hide their latency: what
/// this machine could do at best, now. Takes a quarter of a millisecond or so. Returns how many
/// floating-point operations that were (two each).
double multiply_add_burst(thermorig::network::InstructionSet set);
