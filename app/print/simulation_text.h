// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace thermorig::app {

/// What a header or a world says of a simulation, for a line on the terminal: of a world that turns many
/// knobs the name, and how many. Ready to print. The file and the JSON have all of them.
std::string simulation_text(std::string_view simulation);

/// The line of a run that says so: "SIMULATED rig, seed 3: ports, AVR image, ...".
std::string simulated_line(std::optional<std::uint64_t> seed, std::string_view simulation);

}  // namespace thermorig::app
