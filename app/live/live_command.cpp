// SPDX-License-Identifier: MIT
#include <functional>
#include <memory>

#include "commands.h"
#include "live_facts.h"
#include "live_map.h"
#include "live_model.h"
#include "live_page.h"
#include "live_replay.h"
#include "live_run.h"
#include "live_screens.h"
#include "print/error_output.h"
#include "record/chosen_rig.h"
#include "record/record_checks.h"
#include "record/record_summary.h"
#include "record/recorder.h"
#include "record/recording_setup.h"
#include "record/run_recording.h"
#include "thermorig/io/port.h"

namespace thermorig::app {

namespace {

constexpr PerDevice<bool> needed_devices{{false, false, true}};  // what is left goes on

/// Ports that are named are the whole rig: without one of a servo there is none.
RigOptions with_what_is_there(RigOptions rig) {
  const bool names_other = !rig.ports[Device::camera].empty() || !rig.ports[Device::gyro].empty();
  if (names_other && rig.ports[Device::servo].empty() && rig.profile.empty()) rig.no_servo = true;
  return rig;
}

/// What the recording of a live run has beside that of `record`.
void make_live(const LiveOptions& options, const ChosenModel& model, const estimators::Bank& bank,
               rig::RecordingOptions& recording) {
  recording.keep = options.keep;
  if (!options.keep) recording.preflight = rig::PreflightMode::warn;
  recording.needed = needed_devices;
  recording.wait_for_start = options.record.page.control;
  recording.live_model = model.facts;
  recording.estimators = live::columns_of(bank);
}

void watch(LiveRun& run, const ChosenModel& model, rig::RecordingOptions& recording) {
  recording.begun = [&run, &model, simulated = recording.simulated,
                     frames = recording.plan.frames_per_leg](const RecordingHeader& header) {
    run.begun(header);
    for (const std::string& warning : warnings_of(model, simulated, frames)) run.warn(warning);
  };
  recording.observe = std::bind_front(&LiveRun::observe, &run);
}

/// What is asked of the recording: by the network, by the page, and by the absence of anybody who watches.
std::vector<rig::Order> orders(const LiveOptions& options, LiveRun& run, LivePage* page,
                               const LiveScreens& screens) {
  std::vector<rig::Order> all = orders_of(run, page);
  if (!options.keep && screens.alone()) all.push_back({rig::OrderKind::stop, "its reader, who went away"});
  return all;
}

struct Outcome {
  ExitCode exit = ExitCode::ok;
  std::string next;  // what to type to see what was kept; empty: nothing was
};

/// `ended` tells of an Error as well, and is the last object of --json.
template <typename Drive>
Outcome outcome_of(LiveRun& run, bool keeps, Drive drive) {
  try {
    const rig::RecordingResult result = told(run, drive);
    return {result.exit, keeps ? next_command(result) : ""};
  } catch (const Error& error) {
    return {static_cast<ExitCode>(report(error, false)), ""};
  }
}

}  // namespace

ExitCode run(const LiveOptions& options) {
  if (options.replay) return replay_live(options);
  check_recording_words(options.record);
  ChosenRig rig =
      chosen_rig(with_what_is_there(options.record.rig), options.record.environment, needed_devices);
  rig::SweepPlan plan = chosen_plan(options.record, rig);
  plan.repeat = options.loop;
  if (rig.simulated && !rig.profile.servo.is_there())
    turn_by_hand(rig, options.record.fast ? rig.simulated->start : io::now(), plan.opening_rest_s);
  rig::check_plan(plan, rig.profile.servo, rig.profile.camera);
  if (options.keep) require_output(options.record, rig, plan);
  const ChosenModel model = choose_live_model(options, rig.profile.camera);
  LiveMap map(options.map, rig.profile.camera, rig.simulated.has_value());
  estimators::Bank bank(options.estimators, model.model, rig.profile, model.run, 1, map.begun_with());
  rig::RecordingOptions recording = recording_options(options.record, rig, plan);
  make_live(options, model, bank, recording);
  const std::unique_ptr<LivePage> page =
      options.record.page.serve ? std::make_unique<LivePage>(options.record.page) : nullptr;
  const auto ports = switch_on(options.record, rig, recording);  // outlives the recording
  LiveRun run(live_facts(LiveMode::live, options.record, recording), model, std::move(bank), &map);
  LiveScreens screens(options, page.get(), run);
  watch(run, model, recording);
  const auto drive = [&] {
    rig::RecordingResult result =
        run_recording(rig, options.record.fast,
                      {.recording = std::move(recording),
                       .orders = [&] { return orders(options, run, page.get(), screens); },
                       .progress = [&](const rig::RecordingProgress& progress) { run.progress(progress); },
                       .progress_period = state_period,
                       .notice = [&](const std::string& sentence) { run.note(sentence); }});
    run.write_map(result.session);
    return result;
  };
  const Outcome outcome = outcome_of(run, options.keep, drive);
  screens.finish(outcome.exit, outcome.next);
  return outcome.exit;
}

}  // namespace thermorig::app
