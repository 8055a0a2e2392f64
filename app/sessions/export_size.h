// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace thermorig::app {

/// What a C file takes on a Cortex-M4 with its floating-point unit, as the compiler makes it.
struct CompiledSize {
  std::uint64_t flash_bytes = 0;  // code and constants, without the C library's expf
  std::string compiler;           // in words
};

/// Compiles the file if the board's compiler (arm-none-eabi-gcc) is on this machine; nothing otherwise.
std::optional<CompiledSize> compiled_size(const std::filesystem::path& c_file);

}  // namespace thermorig::app
