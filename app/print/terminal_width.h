// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

namespace thermorig::app {

/// Columns of the terminal on standard output; 80 if it does not say.
std::size_t terminal_width();

}  // namespace thermorig::app
