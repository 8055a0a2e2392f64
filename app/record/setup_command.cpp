// SPDX-License-Identifier: MIT
#include <unistd.h>

#include <iostream>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "calibrate_check.h"
#include "chosen_rig.h"
#include "commands.h"
#include "found_ports.h"
#include "live/live_tui.h"
#include "print/output.h"
#include "profile_path.h"
#include "progress_output.h"
#include "record_checks.h"
#include "recorder.h"
#include "thermorig/io/port.h"
#include "thermorig/rig/profile/profile_file.h"
#include "thermorig/rig/recording/port_recording.h"
#include "thermorig/rig/setup/flash.h"
#include "thermorig/rig/setup/setup.h"
#include "thermorig/simulation/simulated_ports/simulated_ports.h"

namespace thermorig::app {

namespace {

using rig::SetupStep;

/// " --simulated=4 ...", as it was typed; nothing of a real rig.
std::string simulated_words(const RigOptions& options) {
  if (!options.simulated_seed) return "";
  std::string words = fmt::format(" --simulated={}", *options.simulated_seed);
  const SimulatedParts& parts = options.parts;
  const std::pair<const char*, const std::optional<std::string>&> named[] = {
      {"--simulated-servo", parts.servo},
      {"--simulated-camera", parts.camera},
      {"--simulated-gyro", parts.gyro},
      {"--simulated-gyro-protocol", parts.gyro_protocol},
      {"--simulated-encoder", parts.encoder},
      {"--scene", parts.scene},
      {"--world", parts.world}};
  for (const auto& [name, value] : named)
    if (value) words += fmt::format(" {} {}", name, shell_word(*value));
  return words;
}

/// The ports of this computer and the person at its terminal.
class TerminalSetup : public rig::SetupWorld {
 public:
  TerminalSetup(const SetupOptions& options, std::vector<std::string> ports)
      : options_(options), ports_(std::move(ports)) {}

  void begin(SetupStep step) override {
    const auto index = static_cast<std::size_t>(step);
    const std::string_view name = rig::setup_step_names[index];
    if (options_.record.json) return print_json({{"event", "step"}, {"step", name}});
    say(fmt::format("\n{} of {}: {}\n", index + 1, rig::setup_step_names.size(), name));
  }

  std::vector<rig::PortFinding> listen() override {
    std::vector<std::string> there;
    for (const std::string& port : ports_)
      if (std::filesystem::exists(port)) there.push_back(port);
    if (there.empty() && !ports_.empty())
      throw Error(ExitCode::device_missing, "none of these ports exists",
                  fmt::format("{}", fmt::join(ports_, ", ")),
                  "plug the devices in; `thermorig ports` lists the ports");
    const std::vector<io::PortInfo> ports = ports_to_hear(there);
    if (ports.empty())
      throw Error(ExitCode::device_missing, "this computer has no serial port", "",
                  "plug the devices in; without hardware: thermorig setup --simulated=4");
    say(fmt::format("listening to {} port{} for up to 6 s ...\n", ports.size(),
                    ports.size() == 1 ? "" : "s"));
    return rig::identify_devices(ports);
  }

  void show(const RigProfile& profile) override {
    rig::RecordingOptions recording;
    recording.environment = calibration_environment;
    recording.profile = profile;
    rig::SystemPortLoop loop;
    const rig::DevicesSeen seen = rig::see_devices(std::move(recording), loop);
    std::vector<std::string> lines = status_lines(seen.progress);
    lines.resize(std::min<std::size_t>(lines.size(), device_count));
    if (options_.record.json) return print_json({{"event", "devices"}, {"lines", lines}});
    if (seen.frame && escapes_allowed(stdout))
      print("{}", half_blocks(seen.frame->frame, profile.camera.mirrored, terminal_colours()));
    for (const std::string& line : lines) print("{}\n", line);
    flush_output();
  }

  session::Session record(const RigProfile& profile, const rig::SweepPlan& plan) override {
    RecordOptions options = options_.record;
    options.environment = calibration_environment;
    options.preflight = false;  // the last step judges the rig; until then it may be wrongly described
    const ChosenRig rig{profile, std::nullopt};
    rig::check_plan(plan, profile.servo, profile.camera);
    require_output(options, rig, plan);
    const RecordSummary summary = record_session(options, rig, plan);
    const rig::RecordingResult& result = summary.result;
    if (result.session.empty() || (result.exit != ExitCode::ok && result.exit != ExitCode::finished_lossy))
      throw Error(result.exit, result.message, "setup", result.advice);
    return session::read_session(result.session);
  }

  /// One thing to know: lines for people, or an object.
  void say(const std::string& text) override {
    if (options_.record.json) {
      const std::size_t end = text.find_last_not_of('\n');
      return print_json({{"event", "message"}, {"text", text.substr(0, end + 1)}});
    }
    print("{}", text);
    flush_output();
  }

  void confirm(const std::string& question) override {
    if (options_.record.json)
      return print_json({{"event", "question"}, {"text", question}, {"answer", "yes"}});
    if (options_.yes) return say(question + " (--yes)\n");
    say(question + "\n[Enter: yes, n: no] ");
    if (const std::string answer = answered();
        !answer.empty() && answer.front() != 'y' && answer.front() != 'Y')
      throw Error(ExitCode::interrupted, "answered with no: nothing was written", "setup",
                  "fix what is wrong, then thermorig setup again");
  }

  void ask_to(const std::string& request) override {
    if (options_.yes)
      throw Error(ExitCode::device_missing, request + ": a person must do this, but --yes was given", "setup",
                  "name the rig's ports: thermorig setup PORT PORT PORT");
    say(request + ", then press Enter. ");
    answered();
  }

  bool flash(const std::string& port) override {
    if (!options_.flash) return false;
    if (!servo_firmware_image())
      throw Error(ExitCode::failed, "servo_firmware.hex, the firmware's image, is not installed", "setup",
                  "build and flash it by hand (firmware_servo/README.md), then run setup without --flash");
    rig::flash_firmware(
        {.port = port, .image = firmware_image(), .say = [this](const std::string& line) { say(line); }});
    say("flashed\n");
    return true;
  }

  std::string firmware_image() const override {
    return servo_firmware_image().value_or("servo_firmware.hex").string();
  }

  /// A simulated rig has other ports each time, so that it is always set up from its first step.
  std::string command_again(std::optional<SetupStep> from) const override {
    std::string command = "thermorig setup" + simulated_words(options_.record.rig);
    if (!options_.record.rig.simulated_seed) {
      for (const std::string& port : options_.ports) command += " " + shell_word(port);
      if (from) command += fmt::format(" --from {}", rig::setup_step_names[static_cast<std::size_t>(*from)]);
    }
    return command + " --save " + shell_word(options_.save);
  }

 private:
  static std::string answered() {
    std::string answer;
    if (!std::getline(std::cin, answer))
      throw Error(ExitCode::interrupted, "the terminal gave no answer: nothing was written", "setup", "");
    return answer;
  }

  const SetupOptions& options_;
  std::vector<std::string> ports_;
};

void check_words(const SetupOptions& options, SetupStep from) {
  if (options.record.rig.simulated_seed && !options.ports.empty())
    throw Error(ExitCode::bad_usage, "--simulated and ports exclude each other", "", "one of the two");
  if (from != SetupStep::ports && options.record.rig.simulated_seed)
    throw Error(ExitCode::bad_usage, "a simulated rig has other ports each time", "", "leave --from out");
  if (options.record.json && !options.yes)
    throw Error(ExitCode::bad_usage, "setup cannot ask questions with --json", "",
                "--yes answers each question with yes; the servo then moves without being asked");
  if (options.yes || (isatty(STDIN_FILENO) != 0 && isatty(STDOUT_FILENO) != 0)) return;
  throw Error(ExitCode::bad_usage, "setup asks questions, and there is no terminal to answer on", "",
              "--yes answers each with yes; the servo then moves without being asked");
}

/// Which step made what the verdict complains of.
SetupStep step_to_repeat(const session::Quality& quality) {
  const auto mentions = [&](const char* word) {
    return std::any_of(quality.verdict_reasons.begin(), quality.verdict_reasons.end(),
                       [&](const std::string& reason) { return reason.find(word) != std::string::npos; });
  };
  if (mentions("messages were lost") || mentions("sent nothing")) return SetupStep::ports;
  if (mentions("shaft") || mentions("servo delay") || mentions("disagree")) return SetupStep::servo;
  return SetupStep::turns;
}

/// The checks, and a session whose verdict says whether all of it is right.
ExitCode prove(const SetupOptions& options, const RigProfile& profile, TerminalSetup& world) {
  world.begin(SetupStep::session);
  DoctorOptions doctor{options.record};
  doctor.record.plan = "quick";
  doctor.record.rig = RigOptions();
  doctor.record.rig.profile = options.save;
  ExitCode exit = ExitCode::interrupted;
  try {
    exit = run(doctor);
  } catch (const Error& error) {
    if (error.code() != ExitCode::interrupted) throw;
  }
  if (exit != ExitCode::ok) {
    world.say(exit == ExitCode::interrupted ? "stopped: the profile is written  "
                                            : "the profile is written; when that is fixed  ");
    world.say(world.command_again(SetupStep::session) + "\n");
    return exit;
  }
  RecordOptions record = doctor.record;
  const ChosenRig rig{profile, std::nullopt};
  const RecordSummary summary =
      record_session(record, rig, rig::load_plan("quick", record.environment, 1, {}));
  print_summary(summary, record.json);
  require_told(summary);
  const session::Quality& quality = summary.result.quality;
  const std::string simulated = simulated_words(options.record.rig);
  if (summary.result.exit == ExitCode::interrupted)
    world.say("stopped: the profile is written, the session has no verdict  " +
              world.command_again(SetupStep::session) + "\n");
  else if (summary.result.exit == ExitCode::ok && quality.verdict == "good")
    world.say("the rig is ready  thermorig record --environment kitchen --rig " + shell_word(options.save) +
              simulated + "\n");
  else
    world.say("not yet good  " + world.command_again(step_to_repeat(quality)) + "\n");
  return summary.result.exit;
}

}  // namespace

ExitCode run(const SetupOptions& options) {
  const SetupStep from = options.from.empty() ? SetupStep::ports : rig::setup_step_named(options.from);
  check_words(options, from);
  const std::filesystem::path path = profile_path(options.save);
  rig::require_profile_storage(path);
  std::unique_ptr<SimulatedPorts> simulated;
  std::vector<std::string> ports = options.ports;
  if (options.record.rig.simulated_seed) {
    simulated =
        std::make_unique<SimulatedPorts>(simulated_rig(*options.record.rig.simulated_seed,
                                                       options.record.environment, options.record.rig.parts),
                                         FirmwareChoice::avr_image);
    for (const Device device : all_devices) ports.push_back(simulated->paths()[device]);
    simulated->start();
  }
  TerminalSetup world(options, ports);
  if (simulated) world.say(fmt::format("SIMULATED rig, seed {}\n", *options.record.rig.simulated_seed));
  const RigProfile profile = rig::set_up(path, from, world);
  return prove(options, profile, world);
}

}  // namespace thermorig::app
