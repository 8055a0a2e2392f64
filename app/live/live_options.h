// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "options.h"

namespace CLI {
class App;
}

namespace thermorig::app {

/// What stands on the command line of `live`, before it is understood. CLI11 writes into it.
struct LiveCommandLine {
  LiveOptions options;
  std::string speed;
  bool page = false, no_page = false;  // neither: a page, but in virtual time
  const CLI::App* command = nullptr;   // knows which words were said
};

void add_live(CLI::App& root, LiveCommandLine& words);

/// Throws Error(bad_usage) for words that contradict each other.
LiveOptions chosen_live(const LiveCommandLine& words);

/// --page, --page-port, --new-token and --control of a command that can serve the page.
void add_page(CLI::App& command, PageOptions& page);

}  // namespace thermorig::app
