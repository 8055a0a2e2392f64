// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace thermorig::app {

/// Columns of the terminal on standard output; of what is no terminal COLUMNS of the environment, else 80.
std::size_t terminal_width();

/// Lines of more than `width` columns are broken between words and go on below what stands behind their label
/// ("verdict  ...", "  try: ..."). A path or an address is never broken, nor is a line that is too long for
/// the sake of one alone: commands with it can be copied. Lines that steer a terminal stay as they are.
std::string folded(std::string_view text, std::size_t width = terminal_width());

/// `line` in place of the one that was drawn last, cut to `width` columns: one that wraps would stay, and
/// each further one come below it. "" clears it.
std::string drawn_over(std::string_view line, std::size_t width = terminal_width());

}  // namespace thermorig::app
