// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace thermorig::app {

/// Columns of the terminal on standard output; 80 if it does not say.
std::size_t terminal_width();

/// So long a line of standard output may be; nothing: it is no terminal, and any line fits.
std::optional<std::size_t> line_limit();

/// `line` in place of the one that was drawn last, cut to `width` columns: one that wraps would stay, and
/// each further one come below it. "" clears it.
std::string drawn_over(std::string_view line, std::size_t width = terminal_width());

}  // namespace thermorig::app
