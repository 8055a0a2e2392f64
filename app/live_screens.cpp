// SPDX-License-Identifier: MIT
#include "live_screens.h"

#include <cstdio>

#include "live_lines.h"
#include "live_tui.h"
#include "output.h"

namespace thermorig::app {

LiveScreens::LiveScreens(const LiveOptions& options, LivePage* page, LiveRun& run) {
  if (options.record.json) {
    json_ = make_live_json();
    run.add(*json_);
  } else {
    const bool drawable = escapes_allowed(stdout);
    if (options.tui && !drawable)
      std::fputs("--tui needs a terminal that takes escape codes (no NO_COLOR, no TERM=dumb): plain lines\n",
                 stderr);
    screen_ = options.tui && drawable ? make_live_tui(terminal_colours()) : make_live_lines();
    run.add(*screen_);
  }
  if (page == nullptr) return;
  run.add(*page);
  tell_page(*page, options.record.json);
}

}  // namespace thermorig::app
