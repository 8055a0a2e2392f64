// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "calibrate_text.h"
#include "commands.h"
#include "existing_file.h"
#include "output.h"
#include "profile_path.h"
#include "record_checks.h"
#include "recorder.h"
#include "thermorig/io/port.h"
#include "thermorig/rig/profile_file.h"

namespace thermorig::app {

namespace {

using rig::CalibrationKind;

constexpr double full_turn_deg = 360.0;
constexpr double overlap_deg = 40.0;  // a turn that is to close in the image goes on a little
constexpr double hand_turn_s = 20.0;
constexpr double before_hand_turn_s = 15.0;

std::string name_of(CalibrationKind kind) {
  switch (kind) {
    case CalibrationKind::bias:
      return "bias";
    case CalibrationKind::latency:
      return "latency";
    case CalibrationKind::scale:
      return "scale";
    case CalibrationKind::orientation:
      break;
  }
  return "orientation";
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

/// The profile that the result changes: that of the file, else that of the rig that was recorded.
RigProfile profile_before(const std::filesystem::path& path, const session::Session& session) {
  if (!path.empty() && std::filesystem::exists(path)) return rig::read_profile(path);
  RigProfile profile = session.raw.header.profile;
  if (session.raw.header.simulated)
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
  fmt::print(
      "The servo stays still. Leave the rig alone for {:.0f} s, then turn the whole of it by hand {},\n"
      "smoothly, in about {:.0f} s, and leave it alone again until the {:.0f} s are over.\n",
      before_hand_turn_s, turn, turn_duration_s(options), plan.opening_rest_s);
  std::fflush(stdout);
}

bool worth_measuring(const rig::RecordingResult& result) {
  return !result.session.empty() && (result.exit == ExitCode::ok || result.exit == ExitCode::finished_lossy);
}

/// Records the session of the calibration; its path, or the summary's exit code where it ended early.
struct Recorded {
  std::filesystem::path session;
  ExitCode exit = ExitCode::ok;
};

Recorded record_for(const CalibrateOptions& options, ChosenRig rig, const rig::SweepPlan& plan) {
  const RecordOptions& record = options.record;
  rig::check_plan(plan, rig.profile.servo, rig.profile.camera);
  require_output(record, rig, plan);
  if (turned_by_hand(options, plan)) {
    if (rig.simulated) turn_simulated_rig(options, rig);
    if (!record.json && !rig.simulated) ask_for_turn(options, plan);
  }
  const RecordSummary summary = record_session(record, rig, plan);
  if (worth_measuring(summary.result)) return {summary.result.session, ExitCode::ok};
  print_summary(summary, record.json);
  return {{}, summary.result.exit};
}

template <typename Measure>
CalibrationResult combined_over(std::span<const session::Session> sessions, Measure measure) {
  std::vector<decltype(measure(sessions.front()))> results;
  for (const session::Session& session : sessions) results.push_back(measure(session));
  return calibration::combined(results);
}

CalibrationResult measure(const CalibrateOptions& options, std::span<const session::Session> sessions) {
  switch (options.kind) {
    case CalibrationKind::bias:
      return combined_over(sessions, calibration::measure_bias);
    case CalibrationKind::latency:
      return combined_over(sessions, calibration::measure_latency);
    case CalibrationKind::orientation:
      return combined_over(sessions, calibration::measure_orientation);
    case CalibrationKind::scale:
      break;
  }
  if (!options.marks) return combined_over(sessions, calibration::measure_scale);
  return combined_over(sessions, [&](const session::Session& session) {
    return calibration::measure_scale_by_marks(session, options.angle_deg.value_or(full_turn_deg));
  });
}

/// "2026-07-25T14:35:12Z": when the newest of the sessions began.
std::string measured_utc(std::span<const session::Session> sessions) {
  std::string newest;
  for (const session::Session& session : sessions)
    newest = std::max(newest, session.raw.header.start_time_utc);
  const auto fraction = newest.find('.');
  if (fraction != std::string::npos) newest = fmt::format("{}Z", newest.substr(0, fraction));
  return newest;
}

std::string joined(const std::vector<std::filesystem::path>& paths) {
  std::string text;
  for (const auto& path : paths) text += fmt::format("{}{}", text.empty() ? "" : " ", path.string());
  return text;
}

std::string next_command(const CalibrateOptions& options, const std::vector<std::filesystem::path>& paths) {
  const std::string marks =
      options.marks ? fmt::format(" --marks --angle {}", options.angle_deg.value_or(full_turn_deg)) : "";
  return fmt::format("thermorig calibrate {} --session {}{} --save PROFILE", name_of(options.kind),
                     joined(paths), marks);
}

void print_result(const CalibrateOptions& options, const CalibrationResult& result, const RigProfile& before,
                  const std::filesystem::path& kept, const std::vector<std::filesystem::path>& paths) {
  fmt::print("\n{:<12} {}\n{}", "session", joined(paths), text_of(result, before));
  if (!kept.empty())
    fmt::print("{:<12} written to {}\n", "profile", kept.string());
  else
    fmt::print("{:<12} not written to any; keep it with\n{:<12} {}\n", "profile", "",
               next_command(options, paths));
}

void print_result_json(const CalibrateOptions& options, const CalibrationResult& result,
                       const RigProfile& before, const std::string& utc, const std::filesystem::path& kept,
                       const std::vector<std::filesystem::path>& paths) {
  nlohmann::json object = json_of(result, before);
  object["event"] = "summary";
  object["calibration"] = name_of(options.kind);
  object["measured_utc"] = utc;
  object["profile"] = kept.empty() ? nlohmann::json() : nlohmann::json(kept.string());
  object["sessions"] = nlohmann::json::array();
  for (const auto& path : paths) object["sessions"].push_back(path.string());
  print_json(object);
}

std::vector<session::Session> read_sessions(const std::vector<std::filesystem::path>& paths) {
  std::vector<session::Session> sessions;
  for (const auto& path : paths) {
    require_existing(path);
    sessions.push_back(session::read_session(path));
  }
  return sessions;
}

/// A session that cannot tell is named, so that its owner can look at it.
CalibrationResult measure(const CalibrateOptions& options, std::span<const session::Session> sessions,
                          const std::vector<std::filesystem::path>& paths) {
  try {
    return measure(options, sessions);
  } catch (const Error& error) {
    throw Error(error.code(), error.what_happened(), joined(paths), error.advice());
  }
}

ExitCode calibrate(const CalibrateOptions& options, const std::vector<std::filesystem::path>& paths) {
  const std::filesystem::path path = kept_in(options);
  const std::vector<session::Session> sessions = read_sessions(paths);
  const RigProfile before = profile_before(path, sessions.front());
  for (const session::Session& session : sessions)
    if (!path.empty()) refuse_mixture(session.raw.header.simulated, before, path);
  const CalibrationResult result = measure(options, sessions, paths);
  const std::string utc = measured_utc(sessions);
  if (!path.empty()) {
    RigProfile after = before;
    std::visit([&](const auto& found) { calibration::apply(found, utc, after); }, result);
    rig::write_profile(path, after);
  }
  if (options.record.json)
    print_result_json(options, result, before, utc, path, paths);
  else
    print_result(options, result, before, path, paths);
  return ExitCode::ok;
}

}  // namespace

ExitCode run(const CalibrateOptions& options) {
  check_words(options);
  if (!options.sessions.empty()) return calibrate(options, options.sessions);
  const ChosenRig rig = chosen_rig(options.record.rig, options.record.environment);
  const std::filesystem::path path = kept_in(options);
  if (!path.empty() && std::filesystem::exists(path))
    refuse_mixture(rig.simulated.has_value(), rig::read_profile(path), path);
  const rig::SweepPlan plan = plan_of(options, rig);
  if (options.record.dry_run) return print_dry_run(options.record, rig, plan);
  const Recorded recorded = record_for(options, rig, plan);
  return recorded.exit == ExitCode::ok ? calibrate(options, {recorded.session}) : recorded.exit;
}

}  // namespace thermorig::app
