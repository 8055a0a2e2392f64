// SPDX-License-Identifier: MIT
#pragma once

namespace thermorig::app {

/// From here on the first Ctrl-C (or SIGTERM) only is to be asked for; the second ends the program.
void watch_interrupts();

/// Has there been one?
bool interrupted();

/// From here on Ctrl-C, SIGTERM and SIGHUP wait to be asked for, in every thread that is started later.
void hold_interrupts();

/// Until there is one of those that are held.
void wait_for_interrupt();

}  // namespace thermorig::app
