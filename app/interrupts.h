// SPDX-License-Identifier: MIT
#pragma once

namespace thermorig::app {

/// From here on the first Ctrl-C (or SIGTERM) only is to be asked for; the second ends the program.
void watch_interrupts();

/// Has there been one?
bool interrupted();

}  // namespace thermorig::app
