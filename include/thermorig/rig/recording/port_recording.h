// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/core/time.h"
#include "thermorig/rig/discovery/port_loop.h"
#include "thermorig/rig/recording/recording.h"

namespace thermorig::rig {

struct PortOptions {
  RecordingOptions recording;                  // profile: a port for every device
  std::function<std::vector<Order>()> orders;  // asked each tick (10 ms); may be empty
  ProgressHandler progress;                    // called on the recording's thread; may be empty
  HostDuration progress_period = std::chrono::milliseconds(250);
  std::function<void(const std::string&)>
      notice;  // one-line remarks ("stopping the servo ..."); may be empty
};

/// Opens the three ports of this computer, records the plan on the wall clock, finalises. SIGINT, SIGTERM and
/// SIGHUP stop the servo and close the file; a second one leaves the journal for `recover`. Throws Error:
/// device_missing (a port is missing, silent, or carries another device's bytes), no_permission, storage,
/// bad_usage.
RecordingResult record_ports(const PortOptions& options);

/// The same on the ports and the clock of `loop`, which serves nothing else, and is not run again after it.
RecordingResult record_ports(const PortOptions& options, PortLoop& loop);

}  // namespace thermorig::rig
