// SPDX-License-Identifier: MIT
#include "live_screens.h"

#include <cstdio>

#include "interrupts.h"
#include "live_lines.h"
#include "live_tui.h"
#include "page_address.h"
#include "print/output.h"
#include "record/record_summary.h"

namespace thermorig::app {

namespace {

bool draws(const LiveOptions& options) {
  return options.tui && escapes_allowed(stdout);
}

OutputOptions output_options(const LiveOptions& options) {
  OutputOptions output;
  output.waits = options.record.fast || options.replay;
  output.hurried = interrupted;
  if (options.record.json)
    output.of_dropped = dropped_object;
  else if (!draws(options))
    output.of_dropped = dropped_line;
  return output;
}

}  // namespace

LiveScreens::LiveScreens(const LiveOptions& options, LivePage* page, LiveRun& run)
    : output_(output_options(options)), has_page_(page != nullptr) {
  if (page != nullptr) tell_page(page->server(), options.record.json);
  if (options.record.json) {
    json_ = make_live_json(output_);
    run.add(*json_);
  } else {
    const bool drawable = draws(options);
    if (options.tui && !drawable)
      std::fputs("--tui needs a terminal that takes escape codes (no NO_COLOR, no TERM=dumb): plain lines\n",
                 stderr);
    screen_ = drawable ? make_live_tui(output_, terminal_colours()) : make_live_lines(output_);
    run.add(*screen_);
  }
  if (page != nullptr) run.add(*page);
}

void LiveScreens::finish(ExitCode code, const std::string& next) {
  output_.finish();
  if (next.empty()) return output_.require_written(code);
  require_told(output_.failure(code), next);
}

}  // namespace thermorig::app
