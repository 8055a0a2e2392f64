// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "servo_link.h"
#include "thermorig/core/error.h"
#include "thermorig/core/wire_time.h"
#include "thermorig/rig/sweep/plan.h"
#include "thermorig/sensors/camera_protocol.h"

namespace thermorig::rig {

namespace {

// From the last frame's exposure to the servo's next command: transfer, USB latency, one tick of the
// recorder.
constexpr double reaction_s = 0.15;

[[noreturn]] void refuse(const SweepPlan& plan, const std::string& what, const std::string& advice) {
  throw Error(ExitCode::bad_usage, what, "plan " + plan.name, advice);
}

void check_speeds(const SweepPlan& plan, const ServoProfile& servo) {
  const double limit_dps = speed_limit_dps(servo);
  for (const double rate_dps : plan.leg_rates_dps) {
    if (std::abs(rate_dps) <= limit_dps && rate_dps != 0.0) continue;
    refuse(plan,
           fmt::format("{} deg/s is beyond what this servo may be driven at: {} deg/s", rate_dps, limit_dps),
           "leave that speed out, or raise max_rate_dps in the rig profile if the servo can do it");
  }
}

/// The speed v that just leaves `needed_s` between its ramps: v * needed + v^2 / a = stroke.
double fastest_sweep_dps(double stroke_deg, double needed_s, double acceleration_dps2) {
  const double half = 0.5 * needed_s * acceleration_dps2;
  return std::sqrt(half * half + stroke_deg * acceleration_dps2) - half;
}

/// "0.20 s to settle + 0.25 s of exposure + 5 x 0.125 s for 6 frames in a row = 1.08 s".
std::string needed_text(int window_frames, const ServoProfile& servo, const CameraProfile& camera) {
  const double period_s = 1.0 / camera.output_rate_hz;
  const std::string further = window_frames == 1 ? ""
                                                 : fmt::format(" + {} x {:.3f} s for {} frames in a row",
                                                               window_frames - 1, period_s, window_frames);
  return fmt::format("{:.2f} s to settle + {:.2f} s of exposure{} = {:.2f} s", servo.settle_s, 2.0 * period_s,
                     further, window_s(window_frames, servo, camera.output_rate_hz));
}

std::string window_name(int window_frames) {
  return window_frames == 1 ? "valid frame" : fmt::format("valid window of {} frames", window_frames);
}

void check_leg_time(const SweepPlan& plan, double rate_dps, const ServoProfile& servo,
                    const CameraProfile& camera, int window_frames) {
  const double leg_s = plan.frames_per_leg / camera.output_rate_hz;
  const double ramp_s = std::abs(rate_dps) / servo.acceleration_dps2;
  const double needed_s = window_s(window_frames, servo, camera.output_rate_hz);
  if (leg_s - ramp_s >= needed_s) return;
  refuse(plan,
         fmt::format("a leg at {} deg/s is too short for any {}: {} frames at {} Hz = {:.2f} s, minus {:.2f} "
                     "s of ramp = {:.2f} s of constant speed; needed are {}",
                     rate_dps, window_name(window_frames), plan.frames_per_leg, camera.output_rate_hz, leg_s,
                     ramp_s, leg_s - ramp_s, needed_text(window_frames, servo, camera)),
         fmt::format("at least {} frames a leg",
                     static_cast<int>(std::ceil((needed_s + ramp_s) * camera.output_rate_hz))));
}

void check_stroke(const SweepPlan& plan, double rate_dps, const ServoProfile& servo,
                  const CameraProfile& camera, int window_frames) {
  const auto limit_deg = angle_limit_deg(servo);
  if (!limit_deg) return;
  const double stroke_deg = 2.0 * *limit_deg;
  const double ramps_deg = rate_dps * rate_dps / servo.acceleration_dps2;  // one at either end
  const double constant_s = sweep_constant_s(rate_dps, servo);
  const double needed_s = window_s(window_frames, servo, camera.output_rate_hz);
  if (constant_s >= needed_s) return;
  refuse(plan,
         fmt::format("a sweep at {} deg/s is too short for any {}: {} deg of travel, minus {:.1f} deg of "
                     "ramps = {:.2f} s at constant speed; needed are {}, or {:.0f} deg of travel",
                     rate_dps, window_name(window_frames), stroke_deg, ramps_deg, constant_s,
                     needed_text(window_frames, servo, camera),
                     window_travel_deg(rate_dps, window_frames, servo, camera.output_rate_hz)),
         fmt::format("speeds below {:.0f} deg/s, a servo with more travel, or a faster camera",
                     fastest_sweep_dps(stroke_deg, needed_s, servo.acceleration_dps2)));
}

/// The first leg that could not have its valid frames within what a step may take.
void check_quota(const SweepPlan& plan, const ServoProfile& servo, const CameraProfile& camera) {
  if (plan.valid_per_leg == 0) return;
  const double most = static_cast<double>(frames_growth_max) * plan.frames_per_leg;
  for (const ExpectedLeg& leg : expected_legs(plan, servo, camera.output_rate_hz)) {
    if (leg.frames_for_quota <= most) continue;
    const double least = std::ceil(leg.frames_for_quota / frames_growth_max);
    const std::string needed = std::isfinite(leg.frames_for_quota)
                                   ? fmt::format("about {:.0f}", leg.frames_for_quota)
                                   : "endlessly many";
    const std::string longer =
        std::isfinite(least) ? fmt::format(", or at least {:.0f} frames a leg", least) : "";
    refuse(
        plan,
        fmt::format("{} valid frames a leg are out of reach at {:g} deg/s: they need {} frames, and a step "
                    "is given up after {} x {} = {:.0f}",
                    plan.valid_per_leg, leg.rate_dps, needed, frames_growth_max, plan.frames_per_leg, most),
        "fewer valid frames a leg" + longer);
  }
}

void check_camera_link(const SweepPlan& plan, const CameraProfile& camera) {
  const std::uint64_t frame_bytes = sensors::camera_protocol(camera.protocol).message_bytes;
  const auto budget = link_budget(frame_bytes, camera.output_rate_hz, camera.link.baud);
  if (budget.fits()) return;
  const double most_hz = std::floor(budget.max_rate_hz * 10.0) / 10.0;
  const double wire_ms = 1e3 * wire_time_s(frame_bytes, camera.link.baud);
  const auto baud = usual_baud_for(frame_bytes, camera.output_rate_hz);
  refuse(
      plan,
      fmt::format(
          "the camera's link cannot carry {} frames/s: {} bytes x 10 bits / {} baud = {:.1f} ms > {:.1f} ms",
          camera.output_rate_hz, frame_bytes, camera.link.baud, wire_ms, 1e3 / camera.output_rate_hz),
      fmt::format("{}{}{}",
                  baud ? fmt::format("{} baud (set it on the camera and in the rig profile)", *baud) : "",
                  baud && most_hz > 0.0 ? ", or " : "",
                  most_hz > 0.0 ? fmt::format("at most {:.1f} frames/s", most_hz) : ""));
}

}  // namespace

double speed_limit_dps(const ServoProfile& servo) {
  const double profile_limit = servo.kind == ServoKind::continuous
                                   ? std::min(servo.max_rate_dps, servo.full_rate_dps)
                                   : servo.max_rate_dps;
  return std::min(profile_limit, SERVO_LIMIT_RATE_CDPS / 100.0);
}

double stroke_deg(const ServoProfile& servo) {
  const auto limit_deg = angle_limit_deg(servo);
  return limit_deg ? 2.0 * *limit_deg : std::numeric_limits<double>::infinity();
}

std::optional<double> angle_limit_deg(const ServoProfile& servo) {
  if (servo.kind == ServoKind::continuous && servo.travel_deg == 0.0) return std::nullopt;
  return servo.travel_deg / 2.0 - servo.stop_margin_deg;
}

double leg_travel_deg(double rate_dps, double frames, double frame_rate_hz, double acceleration_dps2) {
  const double speed_dps = std::abs(rate_dps);
  // One period more than there are frames: the first one may have begun just before the leg.
  const double driven_s = (frames + 1) / frame_rate_hz + reaction_s;
  return speed_dps * driven_s + speed_dps * speed_dps / (2.0 * acceleration_dps2);
}

void check_plan(const SweepPlan& plan, const ServoProfile& servo, const CameraProfile& camera,
                int window_frames) {
  check_speeds(plan, servo);
  check_camera_link(plan, camera);
  if (plan.for_calibration) return;
  for (const double rate_dps : plan.leg_rates_dps) {
    check_leg_time(plan, rate_dps, servo, camera, window_frames);
    check_stroke(plan, rate_dps, servo, camera, window_frames);
  }
  check_quota(plan, servo, camera);
}

}  // namespace thermorig::rig
