// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "thermorig/core/error.h"

namespace thermorig::app {

/// Prints what happened and what to try to standard error, with --json also as an "error" object on standard
/// output; where unwritten_output() tells of the end of a pipe, only where else the result is. Returns the
/// exit code.
int report(const Error& error, bool json);

/// A file that is refused, in an array of an object a file: `file`, `exit_code`, `error`, `advice`.
nlohmann::json refused_file_json(const std::filesystem::path& file, const Error& error);

}  // namespace thermorig::app
