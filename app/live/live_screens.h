// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "live_page.h"
#include "live_run.h"
#include "options.h"
#include "print/output_writer.h"

namespace thermorig::app {

/// Those who watch a run, as the command line asks for them.
class LiveScreens {
 public:
  /// `page` may be null. Says where the page is.
  LiveScreens(const LiveOptions& options, LivePage* page, LiveRun& run);

  /// Nobody reads the output any more, and nobody else watches: the run has no purpose left.
  bool alone() const { return output_.failed() && !has_page_; }

  /// After the run, which ended as `code`. Throws Error(storage) if the output could not be written; `next`:
  /// what to type to see what was kept.
  void finish(ExitCode code, const std::string& next = "");

 private:
  OutputWriter output_;
  bool has_page_;
  std::unique_ptr<MessageSink> json_;
  std::unique_ptr<LiveScreen> screen_;
};

}  // namespace thermorig::app
