// SPDX-License-Identifier: MIT
#pragma once

namespace thermorig::app {

/// Opens /dev/null on those of the descriptors 0 to 2 that are closed. A file, a port or a socket that came
/// to lie there would be taken for standard input, output or errors: before anything else is opened.
void open_standard_descriptors();

}  // namespace thermorig::app
