// SPDX-License-Identifier: MIT
#include "record_checks.h"

#include <fmt/format.h>
#include <unistd.h>
#include <nlohmann/json.hpp>
#include <nlohmann/json_fwd.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>

#include "print/number_json.h"
#include "print/output.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/wire_time.h"
#include "thermorig/io/files/disk.h"
#include "thermorig/io/port.h"
#include "thermorig/rig/sweep/plan.h"
#include "thermorig/sensors/camera_protocol.h"
#include "thermorig/sensors/gyro_sketch.h"

namespace thermorig::app {

namespace {

using rig::SpeedYield;
using rig::stroke_deg;

std::string windows_text(double windows) {
  return windows < 9.95 ? fmt::format("{:.1f}", windows) : fmt::format("{:.0f}", windows);
}

std::string cell(const SpeedYield::Windows& windows) {
  if (!windows.possible) return "-";
  const std::string leg = windows_text(windows.leg);
  return std::isfinite(windows.sweep) ? leg + " / " + windows_text(windows.sweep) : leg;
}

/// "200 deg/s: 4 frames need 0.825 s = 165 deg + 20 deg of ramps = 185 deg; 5: 190 + 20 deg; 6: 215 + 20
/// deg".
std::string impossible_text(const SpeedYield& speed, const RigProfile& profile) {
  std::string text;
  for (int frames = 1; frames <= rig::window_frames_max; ++frames) {
    const SpeedYield::Windows& windows = speed.windows[static_cast<std::size_t>(frames - 1)];
    if (windows.possible) continue;
    const double needed_s = rig::window_s(frames, profile.servo, profile.camera.output_rate_hz);
    const double constant_deg = speed.rate_dps * needed_s;
    const double ramps_deg = windows.travel_deg - constant_deg;
    if (text.empty())
      text =
          fmt::format("  {:g} deg/s: {} frames need {:.3f} s = {:.0f} deg + {:.0f} deg of ramps = {:.0f} deg",
                      speed.rate_dps, frames, needed_s, constant_deg, ramps_deg, windows.travel_deg);
    else
      text += fmt::format("; {}: {:.0f} + {:.0f} deg", frames, constant_deg, ramps_deg);
  }
  return text.empty() ? "" : text + "\n";
}

std::string impossible_lines(const std::vector<SpeedYield>& speeds, const RigProfile& profile) {
  std::string lines;
  for (const SpeedYield& speed : speeds) lines += impossible_text(speed, profile);
  if (lines.empty()) return "";
  return fmt::format(
      "\nimpossible (-) with the {:g} deg of this servo: {:g} s to settle + {:g} s of exposure + {:g} s for "
      "each "
      "further frame\n{}",
      stroke_deg(profile.servo), profile.servo.settle_s, 2.0 / profile.camera.output_rate_hz,
      1.0 / profile.camera.output_rate_hz, lines);
}

std::string quota_text(const rig::SweepPlan& plan) {
  if (plan.valid_per_leg == 0) return "no quota: a leg ends with its frames";
  return fmt::format("quota: {} valid frames a leg; a leg that has fewer goes on", plan.valid_per_leg);
}

nlohmann::json json_of(const SpeedYield& speed) {
  nlohmann::json object{{"rate_dps", speed.rate_dps}, {"quota_s", speed.duration_s}};
  for (const SpeedYield::Windows& windows : speed.windows) {
    object["leg"].push_back(windows.leg);
    object["sweep"].push_back(number_json(windows.sweep));
    object["travel_deg"].push_back(windows.travel_deg);
    object["possible"].push_back(windows.possible);
  }
  return object;
}

/// How many valid windows each speed of the plan yields, what is impossible and why, how long the quota
/// takes. A table with a line a speed, of a plan that has legs.
std::string yield_text(const rig::SweepPlan& plan, const RigProfile& profile) {
  Table table({">deg/s", ">1 frame", ">2", ">3", ">4", ">5", ">6", ">legs take"});
  const auto speeds = rig::plan_yield(plan, profile.servo, profile.camera.output_rate_hz);
  for (const SpeedYield& speed : speeds) {
    std::vector<std::string> row{fmt::format("{:g}", speed.rate_dps)};
    for (const SpeedYield::Windows& windows : speed.windows) row.push_back(cell(windows));
    row.push_back(duration_text(speed.duration_s));
    table.add(std::move(row));
  }
  const bool has_stops = std::isfinite(stroke_deg(profile.servo));
  return fmt::format(
      "valid windows of 1 to 6 frames in a row that one leg{} brings, and how long the speed's "
      "legs take\n{}{}\n{}",
      has_stops ? " / one sweep from stop to stop" : "", table.text("  "), quota_text(plan),
      impossible_lines(speeds, profile));
}

/// The same: `speeds[]` with arrays by frames a window, from 1. Null in place of infinite numbers.
nlohmann::json yield_json(const rig::SweepPlan& plan, const RigProfile& profile) {
  const double rate_hz = profile.camera.output_rate_hz;
  nlohmann::json speeds = nlohmann::json::array();
  for (const SpeedYield& speed : rig::plan_yield(plan, profile.servo, rate_hz))
    speeds.push_back(json_of(speed));
  return {{"valid_per_leg", plan.valid_per_leg},
          {"stroke_deg", number_json(stroke_deg(profile.servo))},
          {"quota_s", rig::plan_duration_s(plan, profile.servo, rate_hz)},
          {"speeds", speeds}};
}

Check check_link(Device device, const RigProfile& profile) {
  const rig::LinkLoad load = rig::link_load(device, profile);
  const std::uint32_t baud = profile.link(device).baud;
  Check check{.name = std::string(name_of(device)) + " link"};
  if (baud == 0) {
    const bool is_bus = io::is_i2c_bus(profile.link(device).port);
    check.result = is_bus ? "I2C bus, no baud rate" : "USB, no baud rate";
    return check;
  }
  const LinkBudget budget = link_budget(load.message_bytes, load.rate_hz, baud);
  check.result = fmt::format("{} B x {:.0f} /s x 10 bit = {} bit/s of {} ({:.0f} %)", load.message_bytes,
                             load.rate_hz, count_text(static_cast<std::uint64_t>(load.bytes_per_s() * 10)),
                             count_text(baud), 100 * budget.load);
  if (budget.fits()) return check;
  check.code = ExitCode::bad_usage;
  const auto faster = usual_baud_for(load.message_bytes, load.rate_hz);
  if (faster) check.advice = fmt::format("{} baud, on the device and in the rig profile", *faster);
  if (const double most_hz = std::floor(budget.max_rate_hz * 10.0) / 10.0; most_hz > 0.0)
    check.advice += fmt::format("{}at most {:.1f} /s", faster ? ", or " : "", most_hz);
  return check;
}

/// What its rates are not, where that is known of the kind of gyro.
Check check_rates(const std::string& remark) {
  return {.name = "gyro rates", .result = remark, .warning = true};
}

/// What its frames do not tell, until it has been measured.
Check check_exposure(const CameraProfile& camera) {
  return {.name = "camera exposure",
          .result = fmt::format("half-frames are merged: their exposure is known to {:.0f} ms",
                                1e3 * sensors::latency_uncertainty_s(camera)),
          .advice = "thermorig calibrate latency",
          .warning = true};
}

Check check_port(Device device, const RigProfile& profile) {
  const std::string name = std::string(name_of(device)) + " port";
  try {
    return {.name = name, .result = io::resolve_port(profile.link(device).port)};
  } catch (const Error& error) {
    return failed_check(name, error);
  }
}

Check check_plan(const RecordOptions& options, const ChosenRig& rig, const rig::SweepPlan& plan) {
  Check check{.name = "plan"};
  try {
    rig::check_plan(plan, rig.profile.servo, rig.profile.camera, options.frames_per_window);
    check.result = rig.profile.servo.is_there() ? "every speed and every leg is within the servo's limits"
                                                : "no servo: nothing is driven";
  } catch (const Error& error) {
    check.code = error.code();
    check.result = error.what_happened();
    check.advice = error.advice();
  }
  return check;
}

/// Why nothing could be recorded there, and what to try; both empty if it could.
struct Refusal {
  std::string why, advice;
};

Refusal refusal_of(const std::filesystem::path& folder, std::uintmax_t free, std::uint64_t needed) {
  if (!std::filesystem::is_directory(folder))
    return {"; " + folder.string() + " is not a folder", "--output with another folder"};
  if (access(folder.c_str(), W_OK | X_OK) != 0)
    return {"; it cannot be written", "--output with another folder, or change its permissions"};
  if (free < needed)
    return {"; that is too little", "free some space, or record to another disk with --output"};
  return {};
}

Check check_output(const RecordOptions& options, const RigProfile& profile, const rig::SweepPlan& plan) {
  Check check{.name = "output"};
  constexpr double usual_s = 600.0;  // of one that ends when it is stopped
  const std::uint64_t needed =
      rig::expected_recording_bytes(plan.ends_by_stop() ? rig::by_hand_plan(usual_s) : plan, profile);
  const std::filesystem::path folder = files::existing_part(options.output / options.environment);
  std::error_code unknown;
  const std::uintmax_t space = std::filesystem::space(folder, unknown).available;
  const std::uintmax_t free = unknown ? std::numeric_limits<std::uintmax_t>::max() : space;
  const Refusal refusal = refusal_of(folder, free, needed);
  check.result = fmt::format("{}: about {} needed, {} free{}", options.output.string(), bytes_text(needed),
                             unknown ? "unknown" : bytes_text(free), refusal.why);
  if (refusal.why.empty()) return check;
  check.code = ExitCode::storage;
  check.advice = refusal.advice;
  return check;
}

/// Why some legs have more frames than the plan says.
void print_longer_legs(const rig::SweepPlan& plan, const std::vector<rig::ExpectedLeg>& legs) {
  const auto is_longer = [&](const rig::ExpectedLeg& leg) {
    return leg.frames > static_cast<double>(plan.frames_per_leg);
  };
  const auto turns = [&](const rig::ExpectedLeg& leg) { return is_longer(leg) && leg.course.turns_back(); };
  if (std::none_of(legs.begin(), legs.end(), is_longer)) return;
  print("  more than {} frames: what a leg's {} valid ones are expected to take\n", plan.frames_per_leg,
        plan.valid_per_leg);
  if (std::any_of(legs.begin(), legs.end(), turns))
    print(
        "  the travel is too short for such a leg: it goes back and forth, and what it brings in the other\n"
        "  direction the leg of that direction need not bring again\n");
}

void print_legs(const rig::SweepPlan& plan, const ChosenRig& rig) {
  Table table({">leg", ">deg/s", ">frames", ">time"});
  std::size_t number = 0;
  const auto legs = rig::expected_legs(plan, rig.profile.servo, rig.profile.camera.output_rate_hz);
  for (const rig::ExpectedLeg& leg : legs)
    table.add({std::to_string(++number), fmt::format("{:+.1f}", leg.rate_dps),
               fmt::format("{:.0f}", leg.frames), duration_text(leg.duration_s)});
  print("\n{}", table.text("  "));
  print_longer_legs(plan, legs);
}

/// "6 legs of 30 frames, rests of 2.0 s and 2.0 s"; a plan without legs is one rest.
std::string legs_text(const rig::SweepPlan& plan) {
  if (plan.ends_by_stop()) return "until it is stopped";
  if (plan.leg_rates_dps.empty())
    return (plan.for_calibration ? "a rest of " : "turned by hand for ") +
           duration_text(plan.opening_rest_s + plan.closing_rest_s);
  return fmt::format("{} legs of {} frames, rests of {} and {}", plan.leg_rates_dps.size(),
                     plan.frames_per_leg, duration_text(plan.opening_rest_s),
                     duration_text(plan.closing_rest_s));
}

nlohmann::json json_of(const rig::SweepPlan& plan, const RigProfile& profile,
                       const std::vector<Check>& checks) {
  nlohmann::json list = nlohmann::json::array();
  for (const Check& check : checks) list.push_back(check_json(check));
  return {{"event", "summary"},
          {"dry_run", true},
          {"plan", plan.name},
          {"legs_dps", plan.leg_rates_dps},
          {"frames_per_leg", plan.frames_per_leg},
          {"valid_per_leg", plan.valid_per_leg},
          {"opening_rest_s", plan.opening_rest_s},
          {"closing_rest_s", plan.closing_rest_s},
          {"duration_s", rig::plan_duration_s(plan, profile.servo, profile.camera.output_rate_hz)},
          {"yield", yield_json(plan, profile)},
          {"checks", list}};
}

}  // namespace

void print_checks(const std::vector<Check>& checks) {
  Table table({"check", "", ""});
  for (const Check& check : checks) table.add({check.name, check.grade(), check.result});
  print("\n{}", table.text());
  for (const Check& check : checks)
    if ((check.failed() || check.warning) && !check.advice.empty())
      print("  try: {} ({})\n", printable(check.advice), printable(check.name));
}

nlohmann::json check_json(const Check& check) {
  return {{"name", check.name},
          {"ok", !check.failed()},
          {"exit_code", static_cast<int>(check.code)},
          {"result", check.result},
          {"advice", check.advice}};
}

Check failed_check(const std::string& name, const Error& error) {
  return {.name = name,
          .code = error.code(),
          .result = error.where() + ": " + error.what_happened(),
          .advice = error.advice()};
}

void print_remark_on_rates(const RigProfile& profile, bool json) {
  const std::string remark = sensors::remark_on_rates(profile.gyro);
  if (remark.empty()) return;
  if (json)
    print_json({{"event", "note"}, {"message", remark}});
  else
    print("note  {}\n", printable(remark));
}

double recording_bytes_per_s(const RigProfile& profile) {
  double bytes_per_s = 0;
  for (const Device device : all_devices)
    if (profile.has(device)) bytes_per_s += rig::link_load(device, profile).bytes_per_s();
  return bytes_per_s;
}

std::vector<Check> checks_before(const RecordOptions& options, const ChosenRig& rig,
                                 const rig::SweepPlan& plan) {
  std::vector<Check> checks{check_plan(options, rig, plan)};
  for (Device device : all_devices)
    if (rig.profile.has(device)) checks.push_back(check_link(device, rig.profile));
  if (const std::string remark = sensors::remark_on_rates(rig.profile.gyro); !remark.empty())
    checks.push_back(check_rates(remark));
  const CameraProfile& camera = rig.profile.camera;
  if (sensors::camera_protocol(camera.protocol).merges_halves && camera.link.latency_measured_utc.empty())
    checks.push_back(check_exposure(camera));
  if (!rig.simulated)
    for (Device device : all_devices)
      if (rig.profile.has(device)) checks.push_back(check_port(device, rig.profile));
  checks.push_back(check_output(options, rig.profile, plan));
  return checks;
}

void require_output(const RecordOptions& options, const ChosenRig& rig, const rig::SweepPlan& plan) {
  const Check check = check_output(options, rig.profile, plan);
  if (check.code != ExitCode::ok) throw Error(check.code, check.result, "--output", check.advice);
}

ExitCode print_dry_run(const RecordOptions& options, const ChosenRig& rig, const rig::SweepPlan& plan) {
  const std::vector<Check> checks = checks_before(options, rig, plan);
  if (options.json) {
    print_json(json_of(plan, rig.profile, checks));
  } else {
    const double duration_s =
        rig::plan_duration_s(plan, rig.profile.servo, rig.profile.camera.output_rate_hz);
    print("plan {}: {}{}\n", printable(plan.name), legs_text(plan),
          plan.leg_rates_dps.empty() ? "" : ", about " + duration_text(duration_s));
    if (!plan.leg_rates_dps.empty()) {
      print_legs(plan, rig);
      print("\n{}", yield_text(plan, rig.profile));
    }
    print_checks(checks);
  }
  if (const ExitCode code = doctor::exit_code_of(checks); code != ExitCode::ok) return code;
  if (!options.json) print("\nnothing has moved; the same command without --dry-run records\n");
  return ExitCode::ok;
}

}  // namespace thermorig::app
