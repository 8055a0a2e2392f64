// SPDX-License-Identifier: MIT
#include "terminal_width.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>

namespace thermorig::app {

std::size_t terminal_width() {
  winsize size{};
  const bool known = ioctl(fileno(stdout), TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : 80;
}

std::optional<std::size_t> line_limit() {
  return isatty(fileno(stdout)) == 1 ? std::optional(terminal_width()) : std::nullopt;
}

std::string drawn_over(std::string_view line, std::size_t width) {
  return "\r\x1b[K" + std::string(line.substr(0, width - 1));  // a full line would wrap
}

}  // namespace thermorig::app
