// SPDX-License-Identifier: MIT
#pragma once

#include "options.h"
#include "thermorig/core/error.h"

namespace thermorig::app {

/// Is any of the forms that a session can be exported in asked for?
bool is_of_a_session(const ExportOptions& options);

/// Writes a session in these forms. Throws Error(bad_usage) for words that do not go together.
ExitCode export_session(const ExportOptions& options);

}  // namespace thermorig::app
