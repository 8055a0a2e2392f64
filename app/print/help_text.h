// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>

namespace thermorig::app {

/// What CLI11 says of a command, no line longer than `width` columns (60 at least), but for examples, which
/// are for copying.
std::string help_text(const std::string& help, std::size_t width);

}  // namespace thermorig::app
