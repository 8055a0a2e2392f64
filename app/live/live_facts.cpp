// SPDX-License-Identifier: MIT
#include "live_facts.h"

namespace thermorig::app {

LiveFacts live_facts(LiveMode mode, const RecordOptions& options, const rig::RecordingOptions& recording) {
  const rig::SweepPlan& plan = recording.plan;
  LiveFacts facts;
  facts.mode = mode;
  facts.recording = recording.keep;
  facts.output = options.output;
  facts.control = options.page.control;
  facts.plan_name = plan.name;
  facts.legs = plan.leg_rates_dps.size();
  facts.repeats = plan.repeat;
  facts.frames_per_leg = plan.frames_per_leg;
  facts.expected_s =
      rig::plan_duration_s(plan, recording.profile.servo, recording.profile.camera.output_rate_hz);
  return facts;
}

LiveEnd end_of(const rig::RecordingResult& result) {
  return {static_cast<int>(result.exit), result.message, result.advice, result.session.string()};
}

LiveEnd end_of(const Error& error) {
  const std::string where = error.where().empty() ? "" : error.where() + ": ";
  return {static_cast<int>(error.code()), where + error.what_happened(), error.advice(), "", true};
}

}  // namespace thermorig::app
