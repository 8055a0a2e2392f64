// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "live_page.h"
#include "live_run.h"
#include "options.h"

namespace thermorig::app {

/// Those who watch a run, as the command line asks for them.
class LiveScreens {
 public:
  /// `page` may be null. Says where the page is.
  LiveScreens(const LiveOptions& options, LivePage* page, LiveRun& run);

 private:
  std::unique_ptr<MessageSink> json_;
  std::unique_ptr<LiveScreen> screen_;
};

}  // namespace thermorig::app
