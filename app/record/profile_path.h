// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

#include "thermorig/core/profile.h"

namespace thermorig::app {

/// Where a profile lies: a name that holds a '/' or ends in ".toml" is a file; any other, such as "bench", is
/// `$XDG_CONFIG_HOME/thermorig/bench.toml` (`~/.config/...` if that is not set).
std::filesystem::path profile_path(const std::string& name);

/// The profile that lies there. Throws Error(bad_usage) if there is none, or what is there is no profile.
RigProfile read_named_profile(const std::string& name);

}  // namespace thermorig::app
