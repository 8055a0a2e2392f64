// SPDX-License-Identifier: MIT
#pragma once

#include "chosen_rig.h"
#include "options.h"
#include "record_summary.h"
#include "thermorig/rig/sweep/plan.h"

namespace thermorig::app {

/// Throws Error(bad_usage) for a name that no environment can have, and for --fast without a simulated rig.
void check_recording_words(const RecordOptions& options);

/// One acquisition of `plan` in the way that `options` ask for: on ports, on the simulated rig's ports or in
/// virtual time. Shows its progress; does not print the summary. For whoever records: `record`, `calibrate`.
/// Throws as rig::record_ports() and rig::record_virtual() do.
RecordSummary record_session(const RecordOptions& options, const ChosenRig& rig, const rig::SweepPlan& plan);

}  // namespace thermorig::app
