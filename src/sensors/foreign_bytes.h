// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "thermorig/sensors/evidence.h"

namespace thermorig::sensors {

// Streams that are sound, and that no protocol of the tables reads: what they are, and what to do about it.

/// Nothing if the bytes are none of them.
std::optional<Evidence> recognise_foreign(std::span<const std::uint8_t> bytes);

}  // namespace thermorig::sensors
