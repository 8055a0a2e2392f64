// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>

#include "live_run.h"
#include "print/output_writer.h"

namespace thermorig::app {

enum class Colours : std::uint8_t { cube, true_colour };

/// What this terminal can show: COLORTERM says 24 bits, else the cube of 256.
Colours terminal_colours();

/// The image in half blocks, two pixels a character, 12 lines: natural orientation, 2nd to 98th percentile.
/// Each line ends with its colours reset.
std::string half_blocks(const ThermalFrame& frame, bool mirrored, Colours colours);

/// Draws over itself: image, rates, errors, figures. It changes no mode of the terminal, so that nothing is
/// left behind however the program ends.
std::unique_ptr<LiveScreen> make_live_tui(OutputWriter& output, Colours colours);

}  // namespace thermorig::app
