// SPDX-License-Identifier: MIT
#pragma once

#include "options.h"
#include "thermorig/core/error.h"

namespace thermorig::app {

/// The odometer for a board, with the constants of a profile or of a session's profile.
ExitCode export_odometer(const ExportOptions& options);

}  // namespace thermorig::app
