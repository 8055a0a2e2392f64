// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "thermorig/core/error.h"
#include "thermorig/rig/recording/recording.h"

namespace thermorig::app {

/// What is told when a recording has ended.
struct RecordSummary {
  rig::RecordingResult result;
  rig::SweepPlan plan;
  std::optional<double>
      cpu_share;  // of one core, the recorder's own thread while it recorded; none in virtual time
  double wall_s = 0;
  std::optional<Error> unwritten;  // lines of the run that nobody got
};

/// What to type to look at the session, or to make one of the journal that was left.
std::string next_command(const rig::RecordingResult& result);

/// The result; what could not be written of it: require_told().
void print_summary(const RecordSummary& summary, bool json);

/// Throws Error(storage), with what to type next, if a line of the run or its result could not be written.
void require_told(const RecordSummary& summary);

/// The same where another result was printed than the summary. `unwritten`: of the run; `next`: what to type.
void require_told(const std::optional<Error>& unwritten, const std::string& next);

}  // namespace thermorig::app
