// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>

namespace thermorig::app {

/// Columns of the terminal on standard output; 80 if it does not say.
std::size_t terminal_width();

/// So long a line of standard output may be; nothing: it is no terminal, and any line fits.
std::optional<std::size_t> line_limit();

}  // namespace thermorig::app
