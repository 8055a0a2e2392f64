// SPDX-License-Identifier: MIT
#include "thermorig/rig/setup/setup.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "thermorig/core/nearest_name.h"
#include "thermorig/core/printable.h"
#include "thermorig/rig/calibration/calibration.h"
#include "thermorig/rig/profile/profile_file.h"
#include "thermorig/rig/recording/finalise.h"
#include "thermorig/rig/recording/port_recording.h"
#include "thermorig/rig/setup/flash.h"
#include "thermorig/sensors/camera_protocol.h"
#include "thermorig/sensors/gyro_protocol.h"
#include "thermorig/sensors/gyro_sketch.h"
#include "thermorig/sensors/hand_turn.h"

namespace thermorig::rig {

namespace {

constexpr int most_listenings = 4;
constexpr double shown_s = 3.0;
constexpr double gentle_dps = 15.0, firm_dps = 180.0;
constexpr int gentle_frames = 12;
constexpr double same_travel = 0.05;   // by which an uncalibrated gyro and servo may differ
constexpr double gross_travel = 0.4;   // what some small moves can show
constexpr double usual_travel = 0.04;  // as near to a usual one it is that
constexpr std::array usual_travels_deg{90.0, 180.0, 270.0, 360.0, 720.0, 1080.0, 1260.0, 1800.0, 2160.0};

/// The same error, with how to go on: from that step, if there is a profile that knows what comes before.
Error to_repeat(const Error& error, SetupStep step, const std::filesystem::path& path,
                const SetupWorld& world) {
  if (error.code() == ExitCode::interrupted) return error;
  const std::string again =
      world.command_again(std::filesystem::exists(path) ? std::optional(step) : std::nullopt);
  return {error.code(), error.what_happened(), error.where(),
          error.advice() + (error.advice().empty() ? "" : "; then ") + again};
}

// ---- ports ----------------------------------------------------------------------------------------------

std::vector<const PortFinding*> of_role(const std::vector<PortFinding>& findings, Device device) {
  std::vector<const PortFinding*> found;
  for (const PortFinding& finding : findings)
    if (finding.role == device) found.push_back(&finding);
  return found;
}

/// The first role that was found twice.
std::optional<Device> look_alikes(const std::vector<PortFinding>& findings) {
  for (const Device device : all_devices)
    if (of_role(findings, device).size() > 1) return device;
  return std::nullopt;
}

void ask_to_unplug(const std::vector<PortFinding>& findings, Device device, SetupWorld& world) {
  std::string text =
      fmt::format("{} ports look like a {}:\n", of_role(findings, device).size(), name_of(device));
  for (const PortFinding* finding : of_role(findings, device))
    text += fmt::format("  {}  {}\n", printable(finding->info.path), printable(finding->how));
  world.say(text);
  world.ask_to(fmt::format("Unplug each {} that does not belong to this rig", name_of(device)));
}

/// A board without our firmware is a port on which nobody is understood.
void ask_to_flash(const std::vector<PortFinding>& findings, SetupWorld& world) {
  std::vector<std::string> ports;
  for (const PortFinding& finding : findings)
    if (!finding.role && finding.problem.empty()) ports.push_back(finding.info.path);
  if (ports.empty())
    throw Error(ExitCode::device_missing, "no servo answers, and no other port can be its board", "",
                "plug the board in with a USB data cable (some cables only charge)");
  for (const std::string& port : ports) {
    if (world.flash(port)) return;
    std::string text =
        fmt::format("no servo answers. If its board is on {}, flash its firmware:\n", printable(port));
    for (const std::string& command : flash_commands(port, world.firmware_image()))
      text += "  " + command + "\n";
    world.say(text);
  }
  world.ask_to("Flash the board, or plug it in");
}

void require_others(const std::vector<PortFinding>& findings) {
  for (const Device device : {Device::camera, Device::gyro}) {
    if (!of_role(findings, device).empty()) continue;
    const auto closed = std::find_if(findings.begin(), findings.end(),
                                     [](const PortFinding& finding) { return !finding.problem.empty(); });
    if (closed != findings.end())
      throw Error(closed->code == ExitCode::ok ? ExitCode::device_missing : closed->code,
                  fmt::format("no {} was found, and this port cannot be opened: {}", name_of(device),
                              closed->problem),
                  closed->info.path, "thermorig doctor says why");
    throw Error(ExitCode::device_missing, fmt::format("no {} was found on any port", name_of(device)), "",
                "check its cable and supply (thermorig look PORT shows what a port sends)");
  }
}

/// Of lines that do not say it, the columns are guessed and the turns show the unit.
void take_gyro_on_trial(const PortFinding& finding, SetupState& state) {
  if (!finding.text_format || finding.is_known()) return;
  GyroProfile& gyro = state.profile.gyro;
  gyro.protocol = finding.protocol;
  gyro.text = finding.text_format->columns;
  if (!finding.text_format->scale_known) gyro.text.scale_dps = 1.0;
  gyro.link.port = finding.info.path;
  gyro.link.usb_path = finding.info.usb_path;
  if (finding.baud != 0) gyro.link.baud = finding.baud;
  if (finding.rate_hz >= 0.1) gyro.output_rate_hz = std::round(finding.rate_hz * 10.0) / 10.0;
  state.knows_gyro_unit = finding.text_format->scale_known;
}

/// What the devices that were found cannot do: few decimals, a frame of two half-frames.
void say_remarks(const PortFinding& gyro, const RigProfile& profile, SetupWorld& world) {
  const std::string remark = sensors::remark_on_rates(profile.gyro);
  if (!remark.empty()) world.say(fmt::format("gyro: {}\n", remark));
  if (gyro.text_format && (remark.empty() || profile.gyro.sketch.empty()))
    for (const std::string& sentence : gyro.text_format->remarks)
      world.say(fmt::format("gyro: {}\n", printable(sentence)));
  if (sensors::camera_protocol(profile.camera.protocol).merges_halves)
    world.say(fmt::format("camera: {}\n", sensors::merged_halves));
}

// ---- measurements -----------------------------------------------------------------------------------------

/// The session as it would have been recorded with that profile.
session::Session rebuilt(const session::Session& session, const RigProfile& profile) {
  RawRecording raw = session.raw;
  raw.header.profile = profile;
  return build_session(std::move(raw));
}

std::string utc_of(const session::Session& session) {
  const std::string& utc = session.raw.header.start_time_utc;
  const auto fraction = utc.find('.');
  return fraction == std::string::npos ? utc : utc.substr(0, fraction) + "Z";
}

double usual_travel_deg(double travel_deg) {
  for (const double usual_deg : usual_travels_deg)
    if (std::abs(travel_deg / usual_deg - 1.0) < usual_travel) return usual_deg;
  return std::round(travel_deg);
}

/// `share`: of what was commanded, that the shaft turned.
void take_travel(double share, double tolerance, ServoProfile& servo, SetupWorld& world) {
  if (std::abs(share - 1.0) < tolerance) return;
  if (servo.protocol != ServoProfile().protocol)  // a gear behind it; its travel is what the cable bears
    throw Error(ExitCode::finished_lossy,
                fmt::format("the shaft turned by {:.2f} of the commanded angle", share), "servo",
                fmt::format("if there is a gear, set scale = {:.3f} in [servo] of the profile; on a GRBL "
                            "board set $100, the steps per degree",
                            share));
  double& span = servo.kind == ServoKind::continuous ? servo.full_rate_dps : servo.travel_deg;
  const double before = span;
  span = servo.kind == ServoKind::continuous ? std::round(span * share) : usual_travel_deg(span * share);
  world.say(
      fmt::format("servo: it turned by {:.2f} of the commanded angle, so its travel from the shortest to "
                  "the\nlongest pulse is {:g}, not {:g}\n",
                  share, span, before));
}

std::string axis_text(const GyroProfile& gyro) {
  return fmt::format("{}{}", gyro.sign < 0 ? "-" : "+", "xyz"[std::clamp(gyro.axis, 0, 2)]);
}

constexpr double fewest_samples_hz = 8.0;  // of a gyro: as many as frames of a camera

/// The images measure the turns without the gyro, so the ratio is the unit in which it sends.
void take_unit(const Witnesses& witnesses, GyroProfile& gyro, SetupWorld& world) {
  if (!witnesses.images_share || !witnesses.gyro_share || !(std::abs(witnesses.gyro_share->value) > 0.0))
    throw Error(ExitCode::finished_lossy,
                "the images do not show how far the rig turned, so the gyro's unit is not known: " +
                    witnesses.images_why_not,
                "gyro",
                gyro.output_rate_hz < fewest_samples_hz
                    ? "let the gyro print 50 samples a second or more: a frame without a sample is not valid"
                    : "point the camera at something with warm and cold edges, or set scale_dps in "
                      "[gyro.text] of the profile");
  const double scale_dps =
      gyro.text.scale_dps * std::abs(witnesses.images_share->value / witnesses.gyro_share->value);
  const auto unit = sensors::usual_gyro_unit(scale_dps);
  if (!unit)
    throw Error(ExitCode::finished_lossy,
                fmt::format("the gyro's unit is unusual: {:.4g} deg/s according to the images", scale_dps),
                "gyro", "set scale_dps in [gyro.text] of the profile, from the gyro's data sheet");
  gyro.text.scale_dps = unit->scale_dps;
  world.say(fmt::format("gyro: it sends {}\n", unit->name));
}

void take_orientation(const session::Session& session, RigProfile& profile, SetupWorld& world) {
  const calibration::OrientationResult found = calibration::measure_orientation(session);
  calibration::apply(found, utc_of(session), profile);
  world.say(fmt::format("gyro: its axis {} turns with the servo\ncamera: its image is {}\n",
                        axis_text(profile.gyro), found.mirrored ? "mirrored" : "not mirrored"));
}

/// A latency that was not measured stays an assumption, with its wide uncertainty.
void take_latency(const session::Session& session, RigProfile& profile, SetupWorld& world) {
  try {
    const calibration::LatencyResult found = calibration::measure_latency(session);
    calibration::apply(found, utc_of(session), profile);
    world.say(fmt::format("camera: it is late by {:.1f} +- {:.1f} ms\n", 1e3 * found.camera_latency_s.value,
                          1e3 * found.camera_latency_s.uncertainty));
  } catch (const Error& error) {
    if (error.code() != ExitCode::finished_lossy) throw;
    world.say(fmt::format("camera: its latency was not measured: {}\n  later: thermorig calibrate latency\n",
                          printable(error.what_happened())));
  }
}

}  // namespace

SetupState set_up_ports(SetupState state, SetupWorld& world) {
  for (int listening = 0; listening < most_listenings; ++listening) {
    const std::vector<PortFinding> findings = world.listen();
    if (const auto device = look_alikes(findings)) {
      ask_to_unplug(findings, *device, world);
      continue;
    }
    if (state.profile.servo.is_there() && of_role(findings, Device::servo).empty()) {
      ask_to_flash(findings, world);
      continue;
    }
    require_others(findings);
    std::vector<std::string> ambiguous;
    state.profile = apply_findings(std::move(state.profile), findings, ambiguous);
    const PortFinding& gyro = *of_role(findings, Device::gyro).front();
    take_gyro_on_trial(gyro, state);
    say_remarks(gyro, state.profile, world);
    return state;
  }
  throw Error(ExitCode::device_missing, "it is still not clear which ports are the rig's", "",
              "`thermorig ports` shows what is on each; then name them: thermorig setup PORT PORT PORT");
}

DevicesSeen see_devices(RecordingOptions recording, PortLoop& loop) {
  DevicesSeen seen;
  bool is_seen = false, is_stopped = false;
  PortOptions options{.recording = std::move(recording)};
  options.recording.keep = false;
  options.recording.wait_for_start = true;
  options.recording.preflight = PreflightMode::warn;
  options.recording.observe = [&](const Measurement& measurement, HostTime) {
    seen.frame = measurement.frame;
    return std::optional<EstimateRow>();
  };
  options.progress = [&](const RecordingProgress& progress) {
    if (!is_seen) seen.progress = progress;
    is_seen = progress.heard_s >= shown_s;
  };
  options.orders = [&] {
    return is_seen ? std::vector<Order>{{OrderKind::stop, "the setup"}} : std::vector<Order>{};
  };
  options.notice = [&](const std::string&) { is_stopped = true; };  // said of a signal alone
  const RecordingResult result = record_ports(options, loop);
  if (is_stopped) throw Error(ExitCode::interrupted, "stopped: nothing was written", "setup", "");
  if (result.exit != ExitCode::interrupted) throw Error(result.exit, result.message, "setup", result.advice);
  return seen;
}

SetupState set_up_look(SetupState state, SetupWorld& world) {
  world.show(state.profile);
  world.confirm("Are these the devices of your rig?");
  return state;
}

namespace {

/// A servo of 180 degrees makes so little of moves that are small for a winch that its steps hide them.
calibration::GyroAxis axis_by_moves(const RigProfile& profile, SetupWorld& world) {
  try {
    return calibration::measure_axis(
        world.record(profile, setup_moves_plan(profile.servo, profile.camera, gentle_dps)));
  } catch (const Error& error) {
    if (error.code() != ExitCode::finished_lossy || !profile.servo.scale_measured_utc.empty()) throw;
    world.say(fmt::format("{}\n", printable(error.what_happened())));
  }
  const double degrees = firm_dps * gentle_frames / profile.camera.output_rate_hz;
  world.confirm(fmt::format(
      "Again, by {:.0f} degrees if its travel is {:g}, by {:.0f} if it is 180. Is it free to move?", degrees,
      profile.servo.travel_deg, degrees * 180.0 / profile.servo.travel_deg));
  return calibration::measure_axis(
      world.record(profile, setup_moves_plan(profile.servo, profile.camera, firm_dps)));
}

}  // namespace

SetupState set_up_servo(SetupState state, SetupWorld& world) {
  world.confirm(
      fmt::format("The servo now turns by about {:.0f} degrees, there and back. Is it free to move?",
                  gentle_dps * gentle_frames / state.profile.camera.output_rate_hz));
  const calibration::GyroAxis axis = axis_by_moves(state.profile, world);
  state.profile.gyro.axis = axis.axis;
  state.profile.gyro.sign = axis.sign;
  state.knows_gyro_axis = true;
  world.say(fmt::format("servo: it moves; gyro: its axis {} turns with it\n", axis_text(state.profile.gyro)));
  if (state.knows_gyro_unit) take_travel(axis.share, gross_travel, state.profile.servo, world);
  return state;
}

SetupState set_up_turns(SetupState state, SetupWorld& world) {
  const SweepPlan plan = setup_turns_plan(state.profile.servo, state.profile.camera);
  const double fastest_dps = *std::max_element(plan.leg_rates_dps.begin(), plan.leg_rates_dps.end());
  world.confirm(
      fmt::format("The servo now turns there and back for half a minute, at up to {:.0f} deg/s, by up to "
                  "{:.0f} degrees. Is the way free, and does the camera see something warm?",
                  fastest_dps, fastest_dps * plan.frames_per_leg / state.profile.camera.output_rate_hz));
  session::Session session = world.record(state.profile, plan);
  if (!state.knows_gyro_axis) {
    const calibration::GyroAxis axis = calibration::measure_axis(session);
    state.profile.gyro.axis = axis.axis;
    state.profile.gyro.sign = axis.sign;
    session = rebuilt(session, state.profile);
  }
  if (!state.knows_gyro_unit) {
    take_unit(session.sync.witnesses, state.profile.gyro, world);
    state.knows_gyro_unit = true;
    session = rebuilt(session, state.profile);
  }
  const std::optional<Estimate> share = session.sync.witnesses.gyro_share;
  const bool was_mirrored = state.profile.camera.mirrored;
  take_orientation(session, state.profile, world);
  if (state.profile.camera.mirrored != was_mirrored) session = rebuilt(session, state.profile);
  take_latency(session, state.profile, world);
  if (share) take_travel(std::abs(share->value), same_travel, state.profile.servo, world);
  return state;
}

namespace {

/// What a run begins with.
SetupState state_before(const std::filesystem::path& path, SetupStep from) {
  SetupState state;
  if (std::filesystem::exists(path)) {
    state.profile = read_profile(path);
    state.knows_gyro_axis = !state.profile.camera.orientation_measured_utc.empty();
  } else if (from != SetupStep::ports) {
    throw Error(ExitCode::bad_usage, "there is no such profile", path.string(),
                "leave out --from: setup then begins with the ports");
  } else {
    state.profile.name = path.stem().string();
  }
  return state;
}

}  // namespace

RigProfile set_up(const std::filesystem::path& path, SetupStep from, SetupWorld& world) {
  using StepTaken = SetupState (*)(SetupState, SetupWorld&);
  constexpr std::array<StepTaken, 4> steps{set_up_ports, set_up_look, set_up_servo, set_up_turns};
  SetupState state = state_before(path, from);
  if (from == SetupStep::session) return state.profile;
  for (auto step = static_cast<std::size_t>(from); step < steps.size(); ++step) {
    try {
      world.begin(static_cast<SetupStep>(step));
      state = steps[step](std::move(state), world);
    } catch (const Error& error) {
      throw to_repeat(error, static_cast<SetupStep>(step), path, world);
    }
  }
  write_profile(path, state.profile);
  world.say(fmt::format("\nprofile written to {}\n", printable(path.string())));
  return state.profile;
}

SetupStep setup_step_named(const std::string& name) {
  const auto found = std::find(setup_step_names.begin(), setup_step_names.end(), name);
  if (found != setup_step_names.end()) return static_cast<SetupStep>(found - setup_step_names.begin());
  const std::vector<std::string> names(setup_step_names.begin(), setup_step_names.end());
  throw Error(ExitCode::bad_usage, "there is no step \"" + name + "\"", "--from",
              advice_on_name(name, names));
}

SweepPlan setup_moves_plan(const ServoProfile& servo, const CameraProfile& camera, double rate_dps) {
  return reversals_plan("setup-servo", std::array{1.0}, rate_dps, gentle_frames, servo, camera);
}

SweepPlan setup_turns_plan(const ServoProfile& servo, const CameraProfile& camera) {
  constexpr std::array shares{0.3, 0.3, 1.0, 0.6, 0.8};  // slow ones show which way images move
  constexpr double fastest_dps = 100.0, leg_s = 2.0;
  return reversals_plan("setup-turns", shares, fastest_dps,
                        static_cast<int>(std::ceil(leg_s * camera.output_rate_hz)), servo, camera);
}

}  // namespace thermorig::rig
