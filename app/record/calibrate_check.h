// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>

#include "chosen_rig.h"
#include "options.h"
#include "thermorig/core/error.h"
#include "thermorig/rig/sweep/plan.h"

namespace thermorig::app {

/// A session that was recorded to be measured on.
struct CalibrationRecording {
  std::filesystem::path session;  // empty: it ended early, which was told
  ExitCode exit = ExitCode::ok;
  std::optional<Error> unwritten;  // as in RecordSummary
};

/// Records `plan`, and tells how that ended where there is nothing to measure on.
CalibrationRecording record_calibration(const RecordOptions& options, const ChosenRig& rig,
                                        const rig::SweepPlan& plan);

/// `calibrate check`: records a session for it, or takes those that are named, and prints a line a constant
/// of its profile. ExitCode::check_failed if one contradicts.
ExitCode check_calibration(const CalibrateOptions& options);

/// The same before `record`, of the same rig and into the same folder. Throws Error(check_failed) that names
/// what contradicts, with the commands that measure it again, unless `options` take a rig that is not fit.
/// The exit code of the check's own recording where that ended early.
ExitCode check_before_recording(const RecordOptions& options, const ChosenRig& rig);

}  // namespace thermorig::app
