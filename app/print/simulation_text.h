// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

namespace thermorig::app {

/// What a header or a world says of a simulation, for a line on the terminal: of a world that turns many
/// knobs the name, and how many. Ready to print. The file and the JSON have all of them.
std::string simulation_text(std::string_view simulation);

}  // namespace thermorig::app
