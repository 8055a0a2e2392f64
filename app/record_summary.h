// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "thermorig/rig/recording.h"

namespace thermorig::app {

/// What is told when a recording has ended.
struct RecordSummary {
  rig::RecordingResult result;
  rig::SweepPlan plan;
  std::optional<double>
      cpu_share;  // of one core, the recorder's own thread while it recorded; none in virtual time
  double wall_s = 0;
};

void print_summary(const RecordSummary& summary, bool json);

}  // namespace thermorig::app
