// SPDX-License-Identifier: MIT
#include "thermorig/rig/calibration/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "thermorig/fit/shaft/gyro_errors.h"
#include "thermorig/sensors/camera_protocol.h"
#include "thermorig/sensors/servo_protocol.h"

namespace thermorig::calibration {

namespace {

using Constants = std::vector<CheckedConstant>;

// What a session of twenty seconds is trusted to at best. Over eight simulated rigs its scale differed from
// that of `calibrate scale` by 0.1 %, its latency from that of `calibrate latency` by 0.6 ms (RMS).
constexpr double least_scale_uncertainty = 0.001;
constexpr double least_latency_uncertainty_s = 0.001;
constexpr double least_row_uncertainty_s = 1e-4;
// From one time that it is switched on to the next, a gyro's bias moves by as much.
constexpr double least_bias_uncertainty_dps = 0.1;
constexpr double least_speed_uncertainty_dps = 0.3;

// One that tells less would not see a change that matters.
constexpr double worst_scale_uncertainty = 0.015;
constexpr double worst_latency_uncertainty_s = 0.005;
constexpr double worst_filter_uncertainty_s = 0.010;
constexpr double worst_bias_uncertainty_dps = 0.5;
constexpr std::size_t fewest_knots = 3;     // of a clock, that can differ
constexpr double shortest_wander_s = 55.0;  // `wander_ppm` is what a clock does within a minute

constexpr const char* calibrate_scale = "thermorig calibrate scale";
constexpr const char* calibrate_latency = "thermorig calibrate latency";
constexpr const char* calibrate_bias = "thermorig calibrate bias";
constexpr const char* set_bandwidth =
    "set the gyro's bandwidth_hz in the profile, as its settings or its data sheet have it; then thermorig "
    "calibrate latency";

CheckedConstant not_checked(CheckedConstant constant, const std::string& why, const std::string& advice) {
  constant.verdict = ConstantVerdict::not_checked;
  constant.why = why;
  constant.advice = advice;
  return constant;
}

/// How a value that both know is judged.
struct Rule {
  bool measured = true;          // the profile's is no assumption
  double least_uncertainty = 0;  // of the session's
  double worst_uncertainty = 0;
  std::string cause;  // of a contradiction
  std::string unclear = "session too short";
  std::string command;  // that measures it again
};

/// `constant` has both values.
CheckedConstant judged(CheckedConstant constant, const Rule& rule) {
  constant.session->uncertainty = std::hypot(constant.session->uncertainty, rule.least_uncertainty);
  if (!(constant.session->uncertainty <= rule.worst_uncertainty))
    return not_checked(std::move(constant), rule.unclear, rule.command);
  if (contradict(*constant.profile, *constant.session)) {
    constant.verdict = ConstantVerdict::contradicts;
    constant.why = rule.cause;
    constant.advice = rule.command;
  } else if (!rule.measured) {
    return not_checked(std::move(constant), "never measured: the profile assumes it", rule.command);
  } else {
    constant.verdict = ConstantVerdict::holds;
  }
  return constant;
}

/// Before any figure: whether command, gyro and images speak of one motion at all.
CheckedConstant witnesses_of(const session::Session& session) {
  const Witnesses& witnesses = session.sync.witnesses;
  CheckedConstant constant{.name = "command, gyro, images"};
  if (!witnesses.gyro_share) return not_checked(std::move(constant), "no leg could be compared", "");
  constant.verdict = ConstantVerdict::holds;
  if (witnesses.outlier == Witness::none) return constant;
  constant.verdict = ConstantVerdict::contradicts;
  constant.why = witnesses.cause;
  constant.advice = witnesses.remedy;
  return constant;
}

CheckedConstant gyro_scale_of(const session::Session& session) {
  const GyroProfile& profile = session.raw.header.profile.gyro;
  const GyroErrors& errors = session.sync.gyro;
  CheckedConstant constant{.name = "gyro scale",
                           .profile = Estimate{profile.scale, profile.scale_uncertainty},
                           .session = errors.scale_by_turns};
  if (!constant.session) return not_checked(std::move(constant), errors.scale_why_not, calibrate_scale);
  return judged(std::move(constant), {.measured = !profile.scale_measured_utc.empty(),
                                      .least_uncertainty = least_scale_uncertainty,
                                      .worst_uncertainty = worst_scale_uncertainty,
                                      .cause = "whole turns that close in the images have another length",
                                      .command = calibrate_scale});
}

CheckedConstant gyro_bias_of(const session::Session& session) {
  const GyroProfile& profile = session.raw.header.profile.gyro;
  const GyroErrors& errors = session.sync.gyro;
  CheckedConstant constant{.name = "gyro bias",
                           .unit = "deg/s",
                           .profile = Estimate{profile.bias_dps, profile.bias_uncertainty_dps}};
  if (errors.zeroes_itself)
    return not_checked(std::move(constant), "the gyro zeroes itself at rest and so hides its bias",
                       "switch that off in the device (WitMotion: registers 61 and 63)");
  if (!errors.bias_before_dps || !errors.bias_dps)
    return not_checked(std::move(constant), "there was no quiet rest before the first leg",
                       "leave the rig alone on something firm until it moves by itself");
  constant.session = Estimate{*errors.bias_before_dps, errors.bias_dps->uncertainty};
  return judged(std::move(constant),
                {.measured = !profile.bias_measured_utc.empty(),
                 .least_uncertainty = least_bias_uncertainty_dps,
                 .worst_uncertainty = worst_bias_uncertainty_dps,
                 .cause = "the gyro shows another rate at rest: its temperature, or the rig turned",
                 .command = calibrate_bias});
}

/// What the noise at rest alone says of the filter, and what the profile alone does.
GyroErrors filter_by_noise(const session::Session& session) {
  GyroProfile silent = session.raw.header.profile.gyro;
  silent.bandwidth_hz = 0.0;
  GyroErrors errors;
  errors.zeroes_itself = session.sync.gyro.zeroes_itself;
  fit::fit_gyro_filter(session.gyro, session.servo, silent, errors);
  return errors;
}

GyroErrors filter_by_profile(const session::Session& session) {
  GyroErrors errors;
  fit::fit_gyro_filter({}, {}, session.raw.header.profile.gyro, errors);
  return errors;
}

CheckedConstant gyro_filter_of(const session::Session& session) {
  CheckedConstant constant{.name = "gyro filter delay", .unit = "s"};
  const GyroErrors noise = filter_by_noise(session), stated = filter_by_profile(session);
  if (!noise.filter_source.empty()) constant.session = noise.filter_delay_s;
  if (stated.filter_source.empty())
    return not_checked(std::move(constant), "the profile does not state the gyro's bandwidth", set_bandwidth);
  constant.profile = stated.filter_delay_s;
  if (!constant.session)
    return not_checked(std::move(constant),
                       "the gyro's resolution hides its noise at rest, or it rested too little", "");
  return judged(std::move(constant),
                {.worst_uncertainty = worst_filter_uncertainty_s,
                 .cause = "the noise at rest is that of another filter: the gyro was set otherwise",
                 .command = set_bandwidth});
}

/// Where the filter's delay is told by noise, it is told anew by every session.
double filter_scatter_s(const GyroErrors& errors) {
  return errors.filter_source == "noise" ? std::numbers::sqrt2 * errors.filter_delay_s.uncertainty : 0.0;
}

/// What may have changed since the camera was measured against the gyro.
std::string latency_cause(const session::Session& session) {
  if (are_rows_apart(session.sync.camera_offset))
    return "the camera reads its rows one after the other: the middle ones come at another time than was "
           "measured";
  if (session.sync.camera_offset.offset_s->value < 0.0)
    return "the images come earlier against the gyro: its filter was set narrower, or the camera's bridge "
           "has other firmware";
  return "the images come later against the gyro: the camera's bridge or its settings, or the gyro's filter "
         "was set wider";
}

std::string unclear_latency(const CameraOffset& offset) {
  return are_rows_apart(offset) ? "the camera reads its rows one after the other: this session is too short "
                                  "to measure the middle ones"
                                : Rule().unclear;
}

CheckedConstant camera_latency_of(const session::Session& session) {
  const CameraProfile& camera = session.raw.header.profile.camera;
  const PortProfile& link = camera.link;
  const CameraOffset& offset = session.sync.camera_offset;
  CheckedConstant constant{.name = "camera latency",
                           .unit = "s",
                           .profile = Estimate{link.latency_s, sensors::latency_uncertainty_s(camera)}};
  if (!offset.offset_s)
    return not_checked(std::move(constant), "not measured: " + offset.why_not,
                       "point the camera at something with warm and cold edges");
  constant.session = Estimate{link.latency_s + offset.offset_s->value,
                              std::hypot(offset.offset_s->uncertainty, filter_scatter_s(session.sync.gyro))};
  return judged(std::move(constant), {.measured = !link.latency_measured_utc.empty(),
                                      .least_uncertainty = least_latency_uncertainty_s,
                                      .worst_uncertainty = worst_latency_uncertainty_s,
                                      .cause = latency_cause(session),
                                      .unclear = unclear_latency(offset),
                                      .command = calibrate_latency});
}

/// Every session finds it anew and takes it into account: nothing is to be measured again.
CheckedConstant camera_rows_of(const session::Session& session) {
  const CameraOffset& offset = session.sync.camera_offset;
  CheckedConstant constant{.name = "camera rows", .unit = "s/row", .session = offset.row_delay_s};
  if (!offset.row_delay_s)
    return not_checked(std::move(constant), "the images do not tell upper and lower rows apart", "");
  constant.session->uncertainty = std::hypot(offset.row_delay_s->uncertainty, least_row_uncertainty_s);
  if (contradict({}, *constant.session))
    return not_checked(std::move(constant),
                       "the camera reads its rows one after the other: times and labels are those of the "
                       "middle rows",
                       "");
  constant.verdict = ConstantVerdict::holds;
  return constant;
}

void add_servo_speeds(const session::Session& session, Constants& constants) {
  const GyroErrors& gyro = session.sync.gyro;
  const double bias_dps = gyro.bias_dps ? gyro.bias_dps->uncertainty : 0.0;
  for (const ServoResponse::AtSpeed& speed : session.sync.servo.speeds) {
    if (!std::isfinite(speed.reached_dps)) continue;
    const double uncertainty_dps =
        std::hypot(gyro.scale.uncertainty * speed.rate_dps, bias_dps, least_speed_uncertainty_dps);
    CheckedConstant constant{.name = fmt::format("servo at {:+.0f} deg/s", speed.rate_dps),
                             .unit = "deg/s",
                             .profile = Estimate{speed.rate_dps, 0.0},
                             .session = Estimate{speed.reached_dps, uncertainty_dps},
                             .verdict = ConstantVerdict::holds};
    if (speed.contradicts) {
      constant.verdict = ConstantVerdict::contradicts;
      constant.why = "the shaft does not turn as commanded: weak supply, load or servo?";
      constant.advice =
          "a supply of its own for the servo, less load on the shaft, or a plan without that speed "
          "(--speeds, max_rate_dps in the profile); then thermorig calibrate check";
    }
    constants.push_back(std::move(constant));
  }
}

CheckedConstant servo_scale_of(const session::Session& session) {
  const ServoProfile& profile = session.raw.header.profile.servo;
  const GyroErrors& gyro = session.sync.gyro;
  const ServoResponse& servo = session.sync.servo;
  CheckedConstant constant{.name = "servo scale",
                           .profile = Estimate{profile.scale, profile.scale_uncertainty}};
  const auto is_strayed = [](const ServoResponse::AtSpeed& speed) { return speed.contradicts; };
  if (!servo.fitted && std::any_of(servo.speeds.begin(), servo.speeds.end(), is_strayed))
    return not_checked(std::move(constant), "the shaft does not turn as commanded at all speeds", "");
  if (!servo.fitted) return not_checked(std::move(constant), "servo delay not measured", calibrate_scale);
  const double by_gyro = servo.gyro_ratio.value * gyro.scale.uncertainty / std::max(gyro.scale.value, 1e-3);
  constant.session = Estimate{servo.gyro_ratio.value, std::hypot(servo.gyro_ratio.uncertainty, by_gyro)};
  return judged(std::move(constant),
                {.measured = !profile.scale_measured_utc.empty(),
                 .least_uncertainty = least_scale_uncertainty,
                 .worst_uncertainty = worst_scale_uncertainty,
                 .cause = gyro.scale_by_turns ? "the shaft turns further or less far than commanded"
                                              : "shaft and gyro disagree: only a whole turn shows whether "
                                                "the servo's scale changed or the gyro's",
                 .command = calibrate_scale});
}

/// Whether the session's bounds had to have room for more than the profile says. Larger wanders are tried by
/// doubling, so that what was needed is either the profile's or clearly more.
bool wanders_further(const ClockReport& clock, double profile_ppm) {
  if (clock.needed_wander_ppm > 1.5 * profile_ppm) return true;
  return clock.method == "one-way" && clock.knots.size() >= fewest_knots && clock.wander_ppm > profile_ppm;
}

/// Why a clock that nothing speaks against is not said to hold; empty: it is seen to.
std::string why_wander_hides(const ClockReport& clock) {
  const bool is_two_way = clock.method == "two-way";
  const double length_s =
      clock.knots.empty() ? 0.0 : to_s(clock.knots.back().time - clock.knots.front().time);
  if (clock.knots.size() < fewest_knots || (is_two_way && length_s < shortest_wander_s))
    return "session too short";
  if (clock.needed_wander_ppm > 0.0 && clock.bound_wander_ppm > 1.5 * clock.needed_wander_ppm)
    return fmt::format("answers come too late to see a wander below {:.0f} ppm", clock.bound_wander_ppm);
  return "";
}

CheckedConstant clock_of(const session::Session& session, Device device) {
  const ClockReport& clock = session.sync.clock[device];
  CheckedConstant constant{.name = fmt::format("{} clock wander", name_of(device)),
                           .unit = "ppm",
                           .profile = Estimate{session.raw.header.profile.link(device).wander_ppm, 0.0}};
  const auto& servo = sensors::servo_protocol(session.raw.header.profile.servo.protocol);
  if (device == Device::servo && !servo.clock.sends_time())
    return not_checked(std::move(constant), "it sends no time", "");
  if (clock.method.empty())
    return not_checked(std::move(constant), "too little came to fit the clock", "thermorig doctor");
  if (clock.epochs.size() > 1) {
    constant.verdict = ConstantVerdict::contradicts;
    constant.why = "the clock was reset: " + clock.epochs.back().reason;
    constant.advice = "see the supply of its board and its cable; then thermorig calibrate check";
    return constant;
  }
  const bool is_further = wanders_further(clock, constant.profile->value);
  if (const std::string hides = why_wander_hides(clock); !is_further && !hides.empty())
    return not_checked(std::move(constant), hides, "");
  constant.session = Estimate{std::max(clock.wander_ppm, is_further ? clock.needed_wander_ppm : 0.0), 0.0};
  constant.verdict = ConstantVerdict::holds;
  if (!is_further) return constant;
  constant.verdict = ConstantVerdict::contradicts;
  constant.why =
      "the clock, or the host's (NTP?), wanders further than the profile says, which live bounds rest on";
  constant.advice = fmt::format("a larger wander_ppm in [{}] of the profile; then thermorig calibrate check",
                                name_of(device));
  return constant;
}

}  // namespace

std::string_view name_of(ConstantVerdict verdict) {
  constexpr std::string_view names[] = {"holds", "contradicts", "not checked"};
  return names[static_cast<std::size_t>(verdict)];
}

std::vector<CheckedConstant> check_constants(const session::Session& session) {
  const RigProfile& profile = session.raw.header.profile;
  Constants constants;
  if (profile.servo.is_there()) constants.push_back(witnesses_of(session));
  for (const auto& of : {gyro_scale_of, gyro_bias_of, gyro_filter_of, camera_latency_of, camera_rows_of})
    constants.push_back(of(session));
  if (profile.servo.is_there()) {
    constants.push_back(servo_scale_of(session));
    add_servo_speeds(session, constants);
  }
  for (const Device device : all_devices)
    if (profile.has(device)) constants.push_back(clock_of(session, device));
  return constants;
}

bool is_contradicted(const std::vector<CheckedConstant>& constants) {
  return std::any_of(constants.begin(), constants.end(), [](const CheckedConstant& constant) {
    return constant.verdict == ConstantVerdict::contradicts;
  });
}

}  // namespace thermorig::calibration
