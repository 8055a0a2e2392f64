// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <cmath>

#include "thermorig/rig/doctor/checks.h"
#include "thermorig/sensors/wire/reset_cause.h"

namespace thermorig::doctor {

namespace {

// Measured at warm simulated cameras: below 0.8 in 3 s; a cold MLX90640 shows 2 to 4 in its first minutes
// (its data sheet asks for 4 minutes).
constexpr double warm_drift_c_per_min = 1.5;

std::string stream_text(const rig::PreflightStream& stream) {
  return fmt::format(
      "{:.1f} /s (nominal {:.4g}), {:.1f} % lost, {:.1f} % of the bytes damaged, times known to {:.1f} ms",
      stream.rate_hz, stream.nominal_hz, 100.0 * stream.lost_share, 100.0 * stream.damaged_share,
      1e3 * stream.uncertainty_s);
}

Check warm_up_check(const rig::PreflightImages& images) {
  Check check{.name = "camera warm-up",
              .result = fmt::format("its own temperature changes by {:+.1f} degC a minute",
                                    images.sensor_drift_c_per_min)};
  if (std::abs(images.sensor_drift_c_per_min) <= warm_drift_c_per_min) return check;
  check.warning = true;
  check.advice = "wait until it has been on for 4 minutes";
  return check;
}

Check board_check(const rig::PreflightAnswers& answers) {
  const std::string uptime =
      answers.uptime_s > 0.0 ? fmt::format(", on for {:.0f} s", answers.uptime_s) : std::string();
  const std::string watchdog = answers.watchdog_ms > 0 ? fmt::format("watchdog {} ms", answers.watchdog_ms)
                                                       : "no watchdog: " + answers.how_it_rests;
  Check check{.name = "servo board",
              .result = fmt::format("firmware {}{}, at most {:.0f} deg/s, {}", answers.firmware, uptime,
                                    answers.limit_rate_dps, watchdog)};
  if (!wire::was_brown_out(answers.reset_cause)) return check;
  check.warning = true;
  check.result += "; its supply broke down (brown-out), which reset it";
  check.advice =
      "a supply of its own for the servo, with the grounds connected; a capacitor of 470 uF or more at the "
      "servo";
  return check;
}

}  // namespace

std::vector<Check> judge_rig(const rig::PreflightReport& report) {
  std::vector<Check> checks;
  const rig::PreflightFacts& facts = report.facts;
  for (const Device device : all_devices)
    if (facts.streams[device])
      checks.push_back({.name = std::string(name_of(device)) + " stream",
                        .result = stream_text(*facts.streams[device]),
                        .warning = facts.streams[device]->lost_share > rig::PreflightLimits{}.lost_share});
  if (facts.images) checks.push_back(warm_up_check(*facts.images));
  if (facts.rest)
    checks.push_back(
        {.name = "gyro at rest",
         .result = fmt::format("{:.2f} deg/s, noise {:.2f} deg/s, its mean changes by {:.2f} deg/s",
                               facts.rest->mean_dps, facts.rest->noise_dps, facts.rest->swing_dps)});
  if (facts.answers) {
    if (!facts.answers->firmware.empty()) checks.push_back(board_check(*facts.answers));
    checks.push_back(
        {.name = "servo answers",
         .result = fmt::format("{} of {} requests, {:.1f} ms there and back", facts.answers->answered,
                               facts.answers->requests, 1e3 * facts.answers->round_trip_s)});
  }
  for (const rig::PreflightViolation& violation : report.violations)
    checks.push_back({.name = "preflight: " + violation.name,
                      .code = ExitCode::check_failed,
                      .result = rig::sentence(violation),
                      .advice = violation.advice});
  for (const rig::PreflightViolation& warning : report.warnings)
    checks.push_back({.name = "preflight: " + warning.name,
                      .result = rig::sentence(warning),
                      .advice = warning.advice,
                      .warning = true});
  return checks;
}

}  // namespace thermorig::doctor
