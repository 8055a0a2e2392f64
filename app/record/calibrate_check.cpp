// SPDX-License-Identifier: MIT
#include "calibrate_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "print/number_json.h"
#include "print/output.h"
#include "profile_path.h"
#include "record_checks.h"
#include "record_summary.h"
#include "recorder.h"
#include "sessions/session_files.h"
#include "thermorig/rig/calibration/check.h"

namespace thermorig::app {

namespace {

using calibration::CheckedConstant;
using calibration::ConstantVerdict;
using Constants = std::vector<CheckedConstant>;

/// "33.73 +- 0.48 ms"; "-" of what is not known.
std::string value_text(const std::optional<Estimate>& estimate, const std::string& unit) {
  if (!estimate) return "-";
  const bool is_time = unit == "s" || unit == "s/row";
  const double factor = is_time ? 1e3 : 1.0;
  const int digits = unit.empty() ? 4 : unit == "ppm" ? 0 : 2;
  std::string text = fmt::format("{:.{}f}", factor * estimate->value, digits);
  if (estimate->uncertainty > 0.0) text += fmt::format(" +- {:.{}f}", factor * estimate->uncertainty, digits);
  return unit.empty() ? text : fmt::format("{} {}{}", text, is_time ? "m" : "", unit);
}

/// Each once, in the order of the constants, with the names of those that it is for.
std::vector<std::pair<std::string, std::string>> advice_of(const Constants& constants) {
  std::vector<std::pair<std::string, std::string>> all;
  for (const CheckedConstant& one : constants) {
    if (one.advice.empty()) continue;
    const auto known =
        std::find_if(all.begin(), all.end(), [&](const auto& entry) { return entry.first == one.advice; });
    if (known == all.end())
      all.emplace_back(one.advice, one.name);
    else
      known->second += ", " + one.name;
  }
  return all;
}

void print_constants(const std::filesystem::path& session, const Constants& constants) {
  Table table({"constant", ">profile", ">this session", ""});
  for (const CheckedConstant& one : constants)
    table.add({one.name, value_text(one.profile, one.unit), value_text(one.session, one.unit),
               std::string(name_of(one.verdict))});
  std::istringstream rows(table.text());
  std::string text, row;
  std::getline(rows, row);
  for (text = row + "\n"; const CheckedConstant& one : constants) {  // each row, and below it why
    std::getline(rows, row);
    text += row + "\n" + (one.why.empty() ? "" : "  " + printable(one.why) + "\n");
  }
  print("\nsession  {}\n\n{}", printable(session.string()), text);
  for (const auto& [advice, names] : advice_of(constants))
    print("  try: {} ({})\n", printable(advice), printable(names));
  flush_output();
}

nlohmann::json constants_json(const std::filesystem::path& session, const Constants& constants) {
  nlohmann::json list = nlohmann::json::array();
  for (const CheckedConstant& one : constants)
    list.push_back({{"name", one.name},
                    {"unit", one.unit},
                    {"profile", estimate_json(one.profile)},
                    {"session", estimate_json(one.session)},
                    {"verdict", std::string(name_of(one.verdict))},
                    {"why", text_json(one.why)},
                    {"advice", text_json(one.advice)}});
  return {{"session", session.string()},
          {"contradicted", calibration::is_contradicted(constants)},
          {"constants", list}};
}

/// Names what contradicts, and what to do about it.
Error contradiction(Constants constants, const std::filesystem::path& session) {
  std::erase_if(constants,
                [](const CheckedConstant& one) { return one.verdict != ConstantVerdict::contradicts; });
  std::string names, advice;
  for (const auto& [what, whose] : advice_of(constants)) {
    names += (names.empty() ? "" : ", ") + whose;
    advice += (advice.empty() ? "" : "; ") + what;
  }
  return {ExitCode::check_failed, "the profile does not hold any more: " + names, session.string(), advice};
}

[[noreturn]] void refuse_word(const std::string& what, const std::string& advice) {
  throw Error(ExitCode::bad_usage, what, "", advice);
}

void refuse_idle_words(const CalibrateOptions& options) {
  if (!options.save.empty())
    refuse_word("`calibrate check` writes no profile, so --save does nothing",
                "leave --save out; the commands that it names measure again what contradicts");
  if (!options.sessions.empty() && !options.record.rig.profile.empty())
    refuse_word("a session is checked against the profile that it was recorded with",
                "leave --rig out; `thermorig reprocess --rig PROFILE` gives a session other calibrations");
}

ExitCode check_sessions(const CalibrateOptions& options, const std::vector<std::filesystem::path>& paths,
                        const std::optional<Error>& unwritten = {}) {
  nlohmann::json sessions = nlohmann::json::array();
  ExitCode exit = ExitCode::ok;
  for (const auto& path : session_files_at(paths)) {
    const Constants constants = calibration::check_constants(session::read_session(path));
    if (calibration::is_contradicted(constants)) exit = ExitCode::check_failed;
    if (options.record.json)
      sessions.push_back(constants_json(path, constants));
    else
      print_constants(path, constants);
  }
  if (options.record.json)
    print_json({{"event", "summary"},
                {"calibration", "check"},
                {"exit_code", static_cast<int>(exit)},
                {"sessions", sessions}});
  require_told(unwritten, "thermorig calibrate check --session " + shell_word(paths.front().string()));
  return exit;
}

rig::SweepPlan checking_plan(const ChosenRig& rig) {
  return rig::calibration_plan(rig::CalibrationKind::check, rig.profile.servo, rig.profile.camera);
}

CalibrationRecording record_check(const RecordOptions& options, const ChosenRig& rig) {
  const rig::SweepPlan plan = checking_plan(rig);
  rig::check_plan(plan, rig.profile.servo, rig.profile.camera);
  require_output(options, rig, plan);
  return record_calibration(options, rig, plan);
}

bool worth_measuring(const rig::RecordingResult& result) {
  return !result.session.empty() && (result.exit == ExitCode::ok || result.exit == ExitCode::finished_lossy);
}

}  // namespace

CalibrationRecording record_calibration(const RecordOptions& options, const ChosenRig& rig,
                                        const rig::SweepPlan& plan) {
  const RecordSummary summary = record_session(options, rig, plan);
  if (worth_measuring(summary.result)) return {summary.result.session, ExitCode::ok, summary.unwritten};
  print_summary(summary, options.json);
  require_told(summary);
  return {{}, summary.result.exit, {}};
}

ExitCode check_calibration(const CalibrateOptions& options) {
  refuse_idle_words(options);
  if (!options.sessions.empty()) return check_sessions(options, options.sessions);
  const ChosenRig rig = chosen_rig(options.record.rig, options.record.environment);
  if (options.record.dry_run) return print_dry_run(options.record, rig, checking_plan(rig));
  const CalibrationRecording recorded = record_check(options.record, rig);
  if (recorded.exit != ExitCode::ok) return recorded.exit;
  return check_sessions(options, {recorded.session}, recorded.unwritten);
}

ExitCode check_before_recording(const RecordOptions& options, const ChosenRig& rig) {
  RecordOptions own = options;
  own.environment = calibration_environment;
  own.page.serve = false;
  const CalibrationRecording recorded = record_check(own, rig);
  if (recorded.exit != ExitCode::ok) return recorded.exit;
  const Constants constants = calibration::check_constants(session::read_session(recorded.session));
  if (options.json) {
    nlohmann::json event = constants_json(recorded.session, constants);
    event["event"] = "check";
    print_json(event);
  } else {
    print_constants(recorded.session, constants);
    print("\n");
  }
  if (options.preflight && calibration::is_contradicted(constants))
    throw contradiction(constants, recorded.session);
  return ExitCode::ok;
}

}  // namespace thermorig::app
