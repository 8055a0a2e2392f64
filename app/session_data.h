// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "thermorig/windows/acquisition.h"

namespace thermorig::app {

/// Reads the sessions that the paths name, telling on a terminal how far it is. Throws as dataset does.
std::vector<windows::Acquisition> read_data(const std::vector<std::filesystem::path>& paths, bool json);

/// Is any of them of the simulated rig?
bool any_simulated(const std::vector<windows::Acquisition>& acquisitions);

}  // namespace thermorig::app
