// SPDX-License-Identifier: MIT
#include "calibrate_check.h"
#include "chosen_rig.h"
#include "commands.h"
#include "print/output.h"
#include "record_checks.h"
#include "record_summary.h"
#include "recorder.h"
#include "recording_setup.h"
#include "thermorig/io/port.h"

namespace thermorig::app {

namespace {

/// Says what the person at the rig has to do; the simulated rig is turned by hand as well.
void prepare_turns(const RecordOptions& options, const rig::SweepPlan& plan, ChosenRig& rig) {
  if (options.check)
    throw Error(ExitCode::bad_usage, "--check drives the servo, and there is none", "", "leave --check out");
  if (rig.simulated)
    return turn_by_hand(rig, options.fast ? rig.simulated->start : io::now(), plan.opening_rest_s);
  if (options.json) return;
  print(
      "No servo: labels are the gyro's.\n"
      "  1. Leave the rig alone for 10 s, to measure the gyro's bias.\n"
      "  2. Turn all of it, slowly and fast, both ways, more than a whole turn.\n"
      "  3. Leave it alone for the last 5 s{}.\n",
      plan.ends_by_stop() ? ", then press Ctrl-C" : "");
  flush_output();
}

}  // namespace

ExitCode run(const RecordOptions& options) {
  check_recording_words(options);
  ChosenRig rig = chosen_rig(options.rig, options.environment);
  const rig::SweepPlan plan = chosen_plan(options, rig);
  if (options.dry_run) return print_dry_run(options, rig, plan);
  rig::check_plan(plan, rig.profile.servo, rig.profile.camera, options.frames_per_window);
  require_output(options, rig, plan);
  if (!rig.profile.servo.is_there()) prepare_turns(options, plan, rig);
  if (options.check)
    if (const ExitCode exit = check_before_recording(options, rig); exit != ExitCode::ok) return exit;
  print_remark_on_rates(rig.profile, options.json);
  const RecordSummary summary = record_session(options, rig, plan);
  print_summary(summary, options.json);
  require_told(summary);
  return summary.result.exit;
}

}  // namespace thermorig::app
