// SPDX-License-Identifier: MIT
#include "terminal_width.h"

#include <sys/ioctl.h>

#include <cstdio>

namespace thermorig::app {

std::size_t terminal_width() {
  winsize size{};
  const bool known = ioctl(fileno(stdout), TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : 80;
}

}  // namespace thermorig::app
