// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "chosen_rig.h"
#include "commands.h"
#include "options.h"
#include "print/output.h"
#include "record_checks.h"
#include "recording_setup.h"
#include "run_recording.h"
#include "thermorig/io/files/disk.h"
#include "thermorig/io/port.h"
#include "thermorig/rig/doctor/check.h"
#include "thermorig/rig/doctor/checks.h"
#include "thermorig/rig/recording/finalise.h"
#include "thermorig/rig/recording/port_recording.h"
#include "thermorig/rig/recording/virtual_recording.h"

namespace thermorig::app {

namespace {

using Checks = std::vector<Check>;

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
  rig::RecordingOptions recording = recording_options(options, rig, chosen_plan(options, rig));
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
  bool stopped = false;
  const auto notice = [&](const std::string&) { stopped = true; };  // said of a signal alone
  const bool in_virtual_time = rig.simulated.has_value();
  rig::RecordingResult result = run_recording(
      rig, in_virtual_time,
      {.recording = std::move(recording),
       .orders = orders,
       .progress = progress,
       .progress_period = in_virtual_time ? std::chrono::seconds(1) : std::chrono::milliseconds(250),
       .notice = notice});
  if (stopped)
    throw Error(ExitCode::interrupted, "stopped before there was a verdict", "rig", "let it listen for 5 s");
  return result;
}

/// Opens the rig's ports, listens for some seconds and applies the preflight check: nothing is armed, nothing
/// moves, nothing is written. A simulated rig is listened to in virtual time.
Checks listen_to_rig(const RecordOptions& options, const ChosenRig& rig) {
  try {
    const rig::RecordingResult result = listen(listening_options(options, rig), rig);
    if (result.exit == ExitCode::interrupted && result.preflight) return doctor::judge_rig(*result.preflight);
    return {{.name = "rig", .code = result.exit, .result = result.message, .advice = result.advice}};
  } catch (const Error& error) {
    if (error.code() == ExitCode::interrupted) throw;
    return {failed_check("rig", error)};
  }
}

void add(Checks& checks, const Checks& more) {
  checks.insert(checks.end(), more.begin(), more.end());
}

bool names_rig(const RigOptions& rig) {
  bool names = rig.simulated_seed.has_value() || !rig.profile.empty();
  for (const Device device : all_devices) names = names || !rig.ports[device].empty();
  return names;
}

/// The rig's ports, links followed; one that is not there keeps its name, and the check says so.
std::vector<doctor::AskedPort> ports_of(const ChosenRig& rig) {
  std::vector<doctor::AskedPort> ports;
  for (const Device device : all_devices) {
    if (!rig.profile.has(device)) continue;
    std::string path = rig.profile.link(device).port;
    try {
      path = io::resolve_port(path);
    } catch (const Error&) {
      if (path.find('/') == std::string::npos) path = "/dev/" + path;
    }
    ports.push_back({path, device});
  }
  return ports;
}

Check disk_check(const RecordOptions& options, const RigProfile& profile) {
  try {
    const auto folder = files::existing_part(options.output);
    return doctor::judge_disk(doctor::measure_disk(files::real_disk(), folder, io::now),
                              recording_bytes_per_s(profile));
  } catch (const Error& error) {
    return failed_check("disk speed", error);
  }
}

/// Nothing is opened that is known to refuse.
void add_rig_checks(const RecordOptions& options, const ChosenRig& rig, Checks& checks) {
  Checks host;
  if (!rig.simulated) {
    host = doctor::judge_host(doctor::look_at_host("/", ports_of(rig)));
    for (const Check& check : host)
      if (check.code == ExitCode::device_missing || check.code == ExitCode::no_permission) {
        add(checks, host);
        return;
      }
  } else {
    host = doctor::judge_machine(doctor::look_at_host("/", {}));  // of no port
  }
  add(checks, host);
  add(checks, listen_to_rig(options, rig));
}

Checks all_checks(const RecordOptions& options) {
  Checks checks;
  const auto left = doctor::judge_left_parts(options.output, rig::left_parts(options.output));
  if (left) checks.push_back(*left);
  if (!names_rig(options.rig)) {
    add(checks, doctor::judge_host(doctor::look_at_host("/", {})));
    checks.push_back(disk_check(options, RigProfile()));
    return checks;
  }
  const ChosenRig rig = chosen_rig(options.rig, options.environment);
  const rig::SweepPlan plan = chosen_plan(options, rig);
  for (const Check& check : checks_before(options, rig, plan))
    if (!check.name.ends_with(" port")) checks.push_back(check);  // looked at more closely below
  checks.push_back(disk_check(options, rig.profile));
  checks.push_back(doctor::judge_profile(rig.profile));
  add_rig_checks(options, rig, checks);
  return checks;
}

std::size_t count_warnings(const Checks& checks) {
  return static_cast<std::size_t>(std::count_if(
      checks.begin(), checks.end(), [](const Check& check) { return !check.failed() && check.warning; }));
}

/// "not fit to record: camera link, gyro stream", "fit to record, with 2 warnings", "fit to record"; without
/// a rig only of the computer.
std::string verdict_of(const Checks& checks, bool of_rig) {
  std::string failed;
  for (const Check& check : checks)
    if (check.failed()) failed += (failed.empty() ? "" : ", ") + check.name;
  if (!failed.empty()) return "not fit to record: " + failed;
  const std::size_t warnings = count_warnings(checks);
  std::string fit = of_rig ? "fit to record" : "no rig was checked; this computer is fit to record";
  if (warnings == 0) return fit;
  return fmt::format("{}, with {} warning{}", fit, warnings, warnings == 1 ? "" : "s");
}

nlohmann::json json_of(const Checks& checks, bool of_rig) {
  nlohmann::json list = nlohmann::json::array();
  for (const Check& check : checks) {
    list.push_back(check_json(check));
    list.back()["grade"] = check.failed() ? "failed" : check.warning ? "warning" : "ok";
  }
  return {{"verdict", verdict_of(checks, of_rig)},
          {"warnings", count_warnings(checks)},
          {"exit_code", static_cast<int>(doctor::exit_code_of(checks))},
          {"checks", list}};
}

}  // namespace

ExitCode run(const DoctorOptions& options) {
  const Checks checks = all_checks(options.record);
  const bool of_rig = names_rig(options.record.rig);
  if (options.record.json) {
    print_json(json_of(checks, of_rig));
  } else {
    print_checks(checks);
    print("\nverdict  {}\n", printable(verdict_of(checks, of_rig)));
    if (!of_rig) print("next  thermorig doctor --rig PROFILE (listens to the rig as well; nothing moves)\n");
  }
  return doctor::exit_code_of(checks);
}

}  // namespace thermorig::app
