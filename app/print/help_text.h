// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>

namespace thermorig::app {

/// What CLI11 says of a command, for people: choices as one types them, and no line longer than `width`
/// columns (60 at least), but for examples, which are for copying.
std::string help_text(const std::string& printed, std::size_t width);

}  // namespace thermorig::app
