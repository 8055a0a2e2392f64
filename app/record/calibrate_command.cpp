// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "calibrate_check.h"
#include "calibrate_sessions.h"
#include "commands.h"
#include "print/number_json.h"
#include "print/output.h"
#include "profile_path.h"
#include "record_checks.h"
#include "record_summary.h"
#include "recorder.h"
#include "thermorig/io/port.h"
#include "thermorig/rig/profile/profile_file.h"
#include "thermorig/sensors/servo_protocol.h"

namespace thermorig::app {

namespace {

using rig::CalibrationKind;

constexpr double overlap_deg = 40.0;  // a turn that is to close in the image goes on a little
constexpr double hand_turn_s = 20.0;
constexpr double before_hand_turn_s = 15.0;

std::string name_of(CalibrationKind kind) {
  return std::string(calibration_names[static_cast<std::size_t>(kind)]);
}

[[noreturn]] void bad_usage(const std::string& what, const std::string& advice) {
  throw Error(ExitCode::bad_usage, what, "", advice);
}

void check_words(const CalibrateOptions& options) {
  if ((options.marks || options.angle_deg) && options.kind != CalibrationKind::scale)
    bad_usage("--marks and --angle belong to `calibrate scale`", "thermorig calibrate scale --marks");
  if (options.angle_deg && !options.marks)
    bad_usage("--angle is the angle between marks, but the turn is to close in the image",
              "add --marks, or leave --angle out");
  if (options.angle_deg && !(std::abs(*options.angle_deg) >= 90.0 && std::abs(*options.angle_deg) <= 3600.0))
    bad_usage("the angle between the marks is out of range", "90 to 3600 degrees, best 360 or more");
  const RecordOptions& record = options.record;
  if (!options.sessions.empty() && (record.rig.simulated_seed || record.fast || record.dry_run))
    bad_usage("--session takes what was recorded, and then nothing is recorded",
              "leave --simulated, --fast and --dry-run out, or --session");
  check_recording_words(record);
}

/// Where the result is kept; empty: nowhere.
std::filesystem::path kept_in(const CalibrateOptions& options) {
  const std::string& name = options.save.empty() ? options.record.rig.profile : options.save;
  return name.empty() ? std::filesystem::path() : profile_path(name);
}

/// What was measured on a simulated rig must not end up in the profile of a real one.
void refuse_mixture(bool simulated, const RigProfile& profile, const std::filesystem::path& path) {
  if (!simulated) return;
  for (const Device device : all_devices) {
    const std::string& port = profile.link(device).port;
    if (port.empty() || io::is_pseudo_terminal(port)) continue;
    throw Error(ExitCode::bad_usage, "this is the profile of a real rig, and the session is simulated",
                path.string(), "--save with another profile, e.g. --save simulated.toml");
  }
}

/// The profile that the result changes: that of the file, else that of the rig, else the session's own.
RigProfile profile_before(const CalibrateOptions& options, const std::filesystem::path& path,
                          const RecordingHeader& header) {
  if (!path.empty() && std::filesystem::exists(path)) return rig::read_profile(path);
  const std::string& name = options.record.rig.profile;
  RigProfile profile = name.empty() ? header.profile : read_named_profile(name);
  if (header.simulated && name.empty())
    for (const Device device : all_devices) profile.link(device).port.clear();
  return profile;
}

bool turned_by_hand(const CalibrateOptions& options, const rig::SweepPlan& plan) {
  return options.kind == CalibrationKind::scale && plan.leg_rates_dps.empty();
}

double hand_turn_deg(const CalibrateOptions& options) {
  return options.marks ? options.angle_deg.value_or(full_turn_deg) : full_turn_deg + overlap_deg;
}

double turn_duration_s(const CalibrateOptions& options) {
  return std::max(hand_turn_s, hand_turn_s * std::abs(hand_turn_deg(options)) / full_turn_deg);
}

rig::SweepPlan plan_of(const CalibrateOptions& options, const ChosenRig& rig) {
  // Between marks the servo stands still, as where it cannot turn far enough: the plan of a bias, a rest.
  rig::SweepPlan plan = rig::calibration_plan(options.marks ? CalibrationKind::bias : options.kind,
                                              rig.profile.servo, rig.profile.camera);
  if (!options.marks) return plan;
  plan.name = "calibrate-scale";
  plan.opening_rest_s = std::max(plan.opening_rest_s, 2.0 * before_hand_turn_s + turn_duration_s(options));
  return plan;
}

/// The simulated rig has an operator who does what a real one is asked to.
void turn_simulated_rig(const CalibrateOptions& options, ChosenRig& rig) {
  const HostTime start = options.record.fast ? rig.simulated->start : io::now();
  rig.simulated->hand_turns.push_back({.begin = start + from_s(before_hand_turn_s),
                                       .duration_s = turn_duration_s(options),
                                       .angle_deg = hand_turn_deg(options)});
}

void ask_for_turn(const CalibrateOptions& options, const rig::SweepPlan& plan) {
  const std::string turn =
      options.marks ? fmt::format("by {:.0f} degrees, from one mark to the other", hand_turn_deg(options))
                    : std::string("by one turn and a bit more (400 degrees), in one direction");
  print(
      "The servo stays still. Leave the rig alone for {:.0f} s, then turn the whole of it by hand {},\n"
      "smoothly, in about {:.0f} s, and leave it alone again until the {:.0f} s are over.\n",
      before_hand_turn_s, turn, turn_duration_s(options), plan.opening_rest_s);
  flush_output();
}

std::string servos_that_measure_the_shaft() {
  std::vector<std::string_view> names;
  for (const sensors::ServoProtocol& servo :
       sensors::servo_protocols().subspan(1))  // the first needs a sensor
    if (!servo.shaft_sensor.empty()) names.push_back(servo.name);
  return fmt::format("{}", fmt::join(names, " or "));
}

/// Records the session of the calibration.
CalibrationRecording record_for(const CalibrateOptions& options, ChosenRig rig, const rig::SweepPlan& plan) {
  const RecordOptions& record = options.record;
  if (options.kind == rig::CalibrationKind::encoder && rig.simulated &&
      !simulation::measures_shaft(*rig.simulated))
    throw Error(ExitCode::bad_usage, "nothing measures the shaft of this simulated rig", "",
                "--simulated-encoder as5600, or --simulated-servo " + servos_that_measure_the_shaft());
  rig::check_plan(plan, rig.profile.servo, rig.profile.camera);
  require_output(record, rig, plan);
  if (turned_by_hand(options, plan)) {
    if (rig.simulated) turn_simulated_rig(options, rig);
    if (!record.json && !rig.simulated) ask_for_turn(options, plan);
  }
  return record_calibration(record, rig, plan);
}

std::string joined(const std::vector<std::filesystem::path>& paths) {
  std::string text;
  for (const auto& path : paths) text += (text.empty() ? "" : " ") + shell_word(path.string());
  return text;
}

std::string next_calibration(const CalibrateOptions& options,
                             const std::vector<std::filesystem::path>& paths) {
  const std::string marks =
      options.marks ? fmt::format(" --marks --angle {}", options.angle_deg.value_or(full_turn_deg)) : "";
  return fmt::format("thermorig calibrate {} --session {}{} --save PROFILE", name_of(options.kind),
                     joined(paths), marks);
}

void print_result(const MeasuredSessions& measured, const RigProfile& before) {
  for (const SkippedSession& session : measured.skipped)
    print("skipped      {}: {}\n", printable(session.path.string()), printable(session.reason));
  print("\n{:<12} {}\n{}", "session", printable(joined(measured.paths)), text_of(measured.result, before));
  flush_output();
}

void print_kept(const std::filesystem::path& kept, const std::string& next) {
  if (!kept.empty())
    print("{:<12} written to {}\n", "profile", printable(kept.string()));
  else
    print("{:<12} not written to any; keep it with\n{:<12} {}\n", "profile", "", printable(next));
}

void print_result_json(const CalibrateOptions& options, const MeasuredSessions& measured,
                       const RigProfile& before, const std::filesystem::path& kept) {
  nlohmann::json object = calibration_json(measured.result, before);
  object["event"] = "summary";
  object["calibration"] = name_of(options.kind);
  object["measured_utc"] = measured.measured_utc;
  object["profile"] = text_json(kept.string());
  object["sessions"] = nlohmann::json::array();
  for (const auto& path : measured.paths) object["sessions"].push_back(path.string());
  object["skipped"] = nlohmann::json::array();
  for (const SkippedSession& session : measured.skipped)
    object["skipped"].push_back({{"file", session.path.string()}, {"reason", session.reason}});
  print_json(object);
}

/// What was measured is not lost where it cannot be written: the session is there, and how to take it again.
void keep(const CalibrateOptions& options, const MeasuredSessions& measured,
          const std::filesystem::path& path, const std::string& next) {
  try {
    rig::ProfileFile file(path);  // what another calibration has written by now stays
    RigProfile profile = profile_before(options, path, measured.header);
    std::visit([&](const auto& found) { calibration::apply(found, measured.measured_utc, profile); },
               measured.result);
    file.write(profile);
  } catch (const Error& error) {
    throw Error(error.code(), error.what_happened(), error.where(), next);
  }
}

/// `unwritten`: of the recording that was made for it.
ExitCode calibrate(const CalibrateOptions& options, const std::vector<std::filesystem::path>& paths,
                   const std::optional<Error>& unwritten = {}) {
  const std::filesystem::path path = kept_in(options);
  const MeasuredSessions measured = measure_sessions(options, paths);
  const RigProfile before = profile_before(options, path, measured.header);
  if (!path.empty()) refuse_mixture(measured.header.simulated, before, path);
  const std::string next = next_calibration(options, measured.paths);
  const bool json = options.record.json;
  if (json)
    print_result_json(options, measured, before, path);
  else
    print_result(measured, before);
  if (!path.empty()) keep(options, measured, path, next);
  if (!json) print_kept(path, next);
  require_told(unwritten, path.empty() ? next : "the result is in " + path.string());
  return ExitCode::ok;
}

}  // namespace

ExitCode run(const CalibrateOptions& options) {
  check_words(options);
  if (options.kind == CalibrationKind::check) return check_calibration(options);
  const std::filesystem::path path = kept_in(options);
  if (!options.record.rig.profile.empty()) read_named_profile(options.record.rig.profile);
  if (!path.empty()) rig::require_profile_storage(path);
  if (!options.sessions.empty()) return calibrate(options, options.sessions);
  const ChosenRig rig = chosen_rig(options.record.rig, options.record.environment);
  if (!path.empty() && std::filesystem::exists(path))
    refuse_mixture(rig.simulated.has_value(), rig::read_profile(path), path);
  if (!rig.profile.servo.is_there())
    throw Error(ExitCode::bad_usage, "this rig has no servo that could be driven", "",
                "thermorig record --no-servo, then thermorig calibrate " + name_of(options.kind) +
                    " --session with that session, for latency, scale or lens");
  const rig::SweepPlan plan = plan_of(options, rig);
  if (options.record.dry_run) return print_dry_run(options.record, rig, plan);
  const CalibrationRecording recorded = record_for(options, rig, plan);
  if (recorded.exit != ExitCode::ok) return recorded.exit;
  return calibrate(options, {recorded.session}, recorded.unwritten);
}

}  // namespace thermorig::app
