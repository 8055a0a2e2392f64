// SPDX-License-Identifier: MIT
#include "doctor_rig.h"

#include <fmt/format.h>

#include "recording_setup.h"
#include "thermorig/rig/doctor/checks.h"
#include "thermorig/rig/recording/port_recording.h"
#include "thermorig/rig/recording/virtual_recording.h"
#include "virtual_bus.h"

namespace thermorig::app {

namespace {

using Checks = std::vector<doctor::Check>;

constexpr double listen_s = 5.0;

/// Stops the recording, which never began, when the preflight check has heard enough.
class Listening {
 public:
  std::vector<rig::Order> orders() const {
    if (!heard_) return {};
    return {{rig::OrderKind::stop, "the doctor"}};
  }
  void progress(const rig::RecordingProgress& progress) { heard_ = progress.heard_s >= listen_s; }

 private:
  bool heard_ = false;
};

rig::RecordingOptions listening_options(const RecordOptions& options, const ChosenRig& rig) {
  rig::RecordingOptions recording = recording_options(options, rig, chosen_plan(options));
  recording.keep = false;
  recording.wait_for_start = true;
  recording.preflight = rig::PreflightMode::warn;
  recording.replug_patience_s = 0.0;  // a rig that is pulled out meanwhile is not fit
  return recording;
}

rig::RecordingResult listen(rig::RecordingOptions recording, const ChosenRig& rig) {
  Listening listening;
  const auto orders = [&] { return listening.orders(); };
  const auto progress = [&](const rig::RecordingProgress& seen) { listening.progress(seen); };
  if (rig.simulated)
    return record_virtual(*rig.simulated,
                          {.recording = std::move(recording), .orders = orders, .progress = progress});
  bool stopped = false;
  const auto notice = [&](const std::string&) { stopped = true; };  // said of a signal alone
  rig::RecordingResult result = rig::record_ports(
      {.recording = std::move(recording), .orders = orders, .progress = progress, .notice = notice});
  if (stopped)
    throw Error(ExitCode::interrupted, "stopped before there was a verdict", "rig", "let it listen for 5 s");
  return result;
}

doctor::Check refusal(const Error& error) {
  return {.name = "rig",
          .code = error.code(),
          .result = error.where() + ": " + error.what_happened(),
          .advice = error.advice()};
}

}  // namespace

Checks listen_to_rig(const RecordOptions& options, const ChosenRig& rig) {
  try {
    const rig::RecordingResult result = listen(listening_options(options, rig), rig);
    if (result.exit == ExitCode::interrupted && result.preflight) return doctor::judge_rig(*result.preflight);
    return {{.name = "rig", .code = result.exit, .result = result.message, .advice = result.advice}};
  } catch (const Error& error) {
    if (error.code() == ExitCode::interrupted) throw;
    return {refusal(error)};
  }
}

}  // namespace thermorig::app
