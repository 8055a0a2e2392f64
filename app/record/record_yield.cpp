// SPDX-License-Identifier: MIT
#include "record_yield.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "print/number_json.h"
#include "print/output.h"
#include "thermorig/rig/sweep/plan.h"

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

}  // namespace

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

}  // namespace thermorig::app
