// SPDX-License-Identifier: MIT
#include <memory>

#include "chosen_rig.h"
#include "commands.h"
#include "interrupts.h"
#include "live_facts.h"
#include "live_model.h"
#include "live_page.h"
#include "live_replay.h"
#include "live_run.h"
#include "live_screens.h"
#include "record_checks.h"
#include "recorder.h"
#include "recording_setup.h"
#include "thermorig/rig/port_recording.h"
#include "thermorig/rig/virtual_recording.h"
#include "virtual_bus.h"

namespace thermorig::app {

namespace {

constexpr auto state_period = std::chrono::milliseconds(250);
constexpr PerDevice<bool> needed{{false, false, true}};  // what is left goes on

/// What the recording of a live run has beside that of `record`.
void make_live(const LiveOptions& options, const ChosenModel& model, rig::RecordingOptions& recording) {
  recording.keep = options.keep;
  recording.needed = needed;
  recording.wait_for_start = options.record.page.control;
  recording.live_model = model.facts;
}

void watch(LiveRun& run, const ChosenModel& model, rig::RecordingOptions& recording) {
  recording.begun = [&run, &model, simulated = recording.simulated,
                     frames = recording.plan.frames_per_leg](const RecordingHeader& header) {
    run.begun(header);
    for (const std::string& warning : warnings_of(model, simulated, frames)) run.warn(warning);
  };
  recording.observe = [&run](const TimedFrame& frame, const LabelledSample& sample, HostTime arrived) {
    return std::optional(run.frame(frame, sample, arrived));
  };
}

rig::RecordingResult drive_fast(const ChosenRig& rig, rig::RecordingOptions recording, LiveRun& run) {
  watch_interrupts();
  VirtualBus bus(*rig.simulated);
  rig::VirtualOptions options;
  options.recording = std::move(recording);
  options.start = rig.simulated->start;
  options.stop_requested = interrupted;
  options.orders = [&] { return orders_of(run, nullptr); };
  options.progress = [&](const rig::RecordingProgress& progress) { run.progress(progress); };
  options.progress_period = state_period;
  return rig::record_virtual(bus, options);
}

rig::RecordingResult drive_ports(rig::RecordingOptions recording, LiveRun& run, LivePage* page) {
  rig::PortOptions options;
  options.recording = std::move(recording);
  options.orders = [&] { return orders_of(run, page); };
  options.progress = [&](const rig::RecordingProgress& progress) { run.progress(progress); };
  options.progress_period = state_period;
  options.notice = [&](const std::string& sentence) { run.note(sentence); };
  return rig::record_ports(options);
}

}  // namespace

ExitCode run(const LiveOptions& options) {
  if (options.replay) return replay_live(options);
  outlive_readers();
  check_recording_words(options.record);
  const ChosenRig rig = chosen_rig(options.record.rig, options.record.environment, needed);
  rig::SweepPlan plan = chosen_plan(options.record);
  plan.repeat = options.loop;
  rig::check_plan(plan, rig.profile.servo, rig.profile.camera);
  if (options.keep) require_output(options.record, rig, plan);
  const ChosenModel model = read_live_model(options.model);
  rig::RecordingOptions recording = recording_options(options.record, rig, plan);
  make_live(options, model, recording);
  const std::unique_ptr<LivePage> page =
      options.record.page.serve ? std::make_unique<LivePage>(options.record.page) : nullptr;
  const auto ports = switch_on(options.record, rig, recording);  // outlives the recording
  LiveRun run(live_facts(LiveMode::live, options.record, recording), model.model);
  const LiveScreens screens(options, page.get(), run);
  watch(run, model, recording);
  const auto drive = [&] {
    return options.record.fast ? drive_fast(rig, std::move(recording), run)
                               : drive_ports(std::move(recording), run, page.get());
  };
  return told(run, drive).exit;
}

}  // namespace thermorig::app
