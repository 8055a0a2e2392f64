// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "thermorig/sensors/wire/camera_scanner.h"
#include "thermorig/sensors/wire/counters.h"
#include "thermorig/sensors/wire/gyro_message.h"
#include "thermorig/sensors/wire/servo_messages.h"

namespace thermorig::app {

// One decoded message for a person (a line) and for a program (an object). `index` counts from 0.

std::string text_of(const wire::CameraMessage& message, std::uint64_t index);
std::string text_of(const wire::GyroMessage& message, std::uint64_t index);
std::string text_of(const wire::ServoMessage& message, std::uint64_t index);

nlohmann::json message_json(const wire::CameraMessage& message, std::uint64_t index);
nlohmann::json message_json(const wire::GyroMessage& message, std::uint64_t index);
nlohmann::json message_json(const wire::ServoMessage& message, std::uint64_t index);

nlohmann::json counters_json(const wire::Counters& counters);

/// What became of every byte, and how many messages came of them: a few aligned lines.
std::string text_of(const wire::Counters& counters);

}  // namespace thermorig::app
