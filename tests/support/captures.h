// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

namespace thermorig::test {

/// The folder with bytes from real devices: $THERMORIG_CAPTURES, else where the build was told to look.
inline std::filesystem::path captures_folder() {
  const char* chosen = std::getenv("THERMORIG_CAPTURES");
  return chosen != nullptr ? chosen : THERMORIG_CAPTURES_DEFAULT;
}

/// The bytes of one capture, e.g. "gy_mcu90640_serial/roasted-duck.bin"; none if it is not on this machine:
/// skip the test then.
inline std::optional<std::vector<std::uint8_t>> read_capture(const std::string& name) {
  std::ifstream file(captures_folder() / name, std::ios::binary);
  if (!file) return std::nullopt;
  return std::vector<std::uint8_t>(std::istreambuf_iterator<char>(file), {});
}

}  // namespace thermorig::test
