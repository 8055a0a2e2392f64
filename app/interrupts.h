// SPDX-License-Identifier: MIT
#pragma once

namespace thermorig::app {

/// From here on the first Ctrl-C (or SIGTERM) only is to be asked for; the second ends the program.
void watch_interrupts();

/// Has there been one?
bool interrupted();

/// From here on a reader of our output that goes away ends neither a recording nor a run: writing fails, and
/// the exit code says so.
void outlive_readers();

}  // namespace thermorig::app
