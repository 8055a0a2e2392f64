// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/core/error.h"

namespace thermorig::app {

/// Prints what happened and what to try to standard error, with --json also as an "error" object on standard
/// output. Returns the exit code.
int report(const Error& error, bool json);

}  // namespace thermorig::app
