// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "live/live_page.h"
#include "live/live_run.h"
#include "options.h"
#include "thermorig/rig/recording/recording.h"

namespace thermorig::app {

/// The page of `record`: the same as that of `live`, gyro against servo, and nothing of it is kept.
class RecordPage {
 public:
  /// Starts the server, says where it is, and watches `recording`.
  RecordPage(const RecordOptions& options, rig::RecordingOptions& recording);

  void progress(const rig::RecordingProgress& progress) { run_.progress(progress); }
  std::vector<rig::Order> take_orders() { return orders_of(run_, &page_); }
  void ended(const LiveEnd& end) { run_.ended(end); }

 private:
  LivePage page_;
  LiveRun run_;
};

}  // namespace thermorig::app
