// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "chosen_rig.h"
#include "options.h"
#include "thermorig/core/error.h"
#include "thermorig/rig/plan.h"

namespace thermorig::app {

/// One thing that was looked at before a recording, and what came of it.
struct Check {
  std::string name;
  ExitCode code = ExitCode::ok;
  std::string result;  // the figures, or what is wrong
  std::string advice;
};

/// All that can be said without moving anything and without opening a port.
std::vector<Check> checks_before(const RecordOptions& options, const ChosenRig& rig,
                                 const rig::SweepPlan& plan);

/// Throws Error(storage) if the recording could not be written: before anything is printed or opened.
void require_output(const RecordOptions& options, const ChosenRig& rig, const rig::SweepPlan& plan);

/// Prints the plan leg by leg, its duration and the checks. Returns the code of the first check that failed.
ExitCode print_dry_run(const RecordOptions& options, const ChosenRig& rig, const rig::SweepPlan& plan);

}  // namespace thermorig::app
