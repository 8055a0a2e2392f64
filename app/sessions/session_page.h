// SPDX-License-Identifier: MIT
#pragma once

#include "options.h"
#include "thermorig/core/error.h"

namespace thermorig::app {

/// Throws Error(failed) if this program was built without its page.
void require_page();

/// `inspect --html`: writes a session's page into one file. Throws Error(bad_usage) for words that do not go
/// with it, Error(storage) if the file exists or cannot be written.
ExitCode write_session_page(const InspectOptions& options);

/// `inspect --plots`: writes figures and tables of each session. Throws Error(bad_usage) for words that do
/// not go with it, and as write_plots() does.
ExitCode write_session_plots(const InspectOptions& options);

}  // namespace thermorig::app
