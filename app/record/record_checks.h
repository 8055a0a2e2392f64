// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "chosen_rig.h"
#include "options.h"
#include "thermorig/core/error.h"
#include "thermorig/rig/doctor/check.h"
#include "thermorig/rig/sweep/plan.h"

namespace thermorig::app {

using doctor::Check;

/// One line a check, and below them what to try.
/// Before a recording: what is to be known of the rates of such a gyro, if anything.
void print_remark_on_rates(const RigProfile& profile, bool json);
void print_checks(const std::vector<Check>& checks);
nlohmann::json check_json(const Check& check);

/// The check that met `error`.
Check failed_check(const std::string& name, const Error& error);

/// What the devices of a rig send, bytes a second: what its journal grows by.
double recording_bytes_per_s(const RigProfile& profile);

/// All that can be said without moving anything and without opening a port.
std::vector<Check> checks_before(const RecordOptions& options, const ChosenRig& rig,
                                 const rig::SweepPlan& plan);

/// Throws Error(storage) if the recording could not be written: before anything is printed or opened.
void require_output(const RecordOptions& options, const ChosenRig& rig, const rig::SweepPlan& plan);

/// Prints the plan leg by leg, its duration and the checks. Returns the code of the first check that failed.
ExitCode print_dry_run(const RecordOptions& options, const ChosenRig& rig, const rig::SweepPlan& plan);

}  // namespace thermorig::app
