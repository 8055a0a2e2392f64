// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "gy_mcu90640.h"
#include "thermorig/sensors/wire/checksums.h"

namespace thermorig::test {

/// What a GY-MCU90640 can be told. The program tells it nothing.
inline std::vector<std::uint8_t> camera_command(std::uint8_t command, std::uint8_t value) {
  std::vector<std::uint8_t> bytes{gy_mcu90640::command_sync, command, value};
  bytes.push_back(wire::byte_sum8(bytes));
  return bytes;
}

/// Its reply to "read emissivity", which may stand between frames or inside one.
inline std::vector<std::uint8_t> camera_emissivity_reply(std::uint8_t hundredths) {
  std::vector<std::uint8_t> bytes{gy_mcu90640::sync, gy_mcu90640::sync, hundredths};
  bytes.push_back(wire::byte_sum8(bytes));
  return bytes;
}

}  // namespace thermorig::test
