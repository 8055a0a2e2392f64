// SPDX-License-Identifier: MIT
#include "standard_descriptors.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>

#include "thermorig/core/error.h"

namespace thermorig::app {

void open_standard_descriptors() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(descriptor, F_GETFD) >= 0 || errno != EBADF) continue;
    // The system gives the lowest number that is free, and those below are not.
    if (open("/dev/null", O_RDWR) != descriptor) std::_Exit(static_cast<int>(ExitCode::failed));
  }
}

}  // namespace thermorig::app
