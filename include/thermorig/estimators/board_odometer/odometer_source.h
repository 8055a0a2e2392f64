// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/network/embedded/c_text.h"

namespace thermorig::board_odometer {

/// The odometer as C99 for small boards: no heap, single precision, of the C library sqrtf and what copies
/// memory. It is not the product's: docs/decisions/0018-odometer-on-a-board.md says what differs.
struct OdometerSource {
  std::vector<embedded::SourceFile> files;  // <name>.h, <name>.c, and <name>_rig.h: the rig's constants
  std::size_t state_bytes = 0;              // RAM, the caller's
  std::size_t stack_bytes = 0;              // at most
};

/// `name`: prefix of files and symbols, a C identifier. Throws Error(bad_usage) if it is none, and where the
/// board's odometer has no room for the rig: lenses of 30 to 115 degrees, 0.5 frames a second or more.
OdometerSource odometer_source(const RigProfile& rig, const std::string& name);

}  // namespace thermorig::board_odometer
