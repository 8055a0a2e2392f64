// SPDX-License-Identifier: MIT
#include "calibrate_check.h"
#include "chosen_rig.h"
#include "commands.h"
#include "record_checks.h"
#include "record_summary.h"
#include "recorder.h"
#include "recording_setup.h"

namespace thermorig::app {

ExitCode run(const RecordOptions& options) {
  check_recording_words(options);
  const ChosenRig rig = chosen_rig(options.rig, options.environment);
  const rig::SweepPlan plan = chosen_plan(options);
  if (options.dry_run) return print_dry_run(options, rig, plan);
  rig::check_plan(plan, rig.profile.servo, rig.profile.camera, options.frames_per_window);
  require_output(options, rig, plan);
  if (options.check)
    if (const ExitCode exit = check_before_recording(options, rig); exit != ExitCode::ok) return exit;
  print_remark_on_rates(rig.profile, options.json);
  const RecordSummary summary = record_session(options, rig, plan);
  print_summary(summary, options.json);
  require_told(summary);
  return summary.result.exit;
}

}  // namespace thermorig::app
