// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "thermorig/sensors/wire/servo_messages.h"

namespace thermorig::wire {

/// Length of the payload of a message from the servo; 0 for a type that it does not send.
std::size_t servo_payload_size(std::uint8_t type);

/// The message in the payload of a good frame; none if the servo sends no such type, not of this length, or
/// not with these values.
std::optional<ServoBody> read_servo_payload(std::uint8_t type, std::span<const std::uint8_t> payload);

}  // namespace thermorig::wire
