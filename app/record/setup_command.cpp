// SPDX-License-Identifier: MIT
#include <unistd.h>

#include <cstdlib>
#include <iostream>
#include <memory>
#include <optional>

#include <fmt/format.h>

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
#include "thermorig/rig/setup/setup.h"
#include "thermorig/simulation/simulated_ports/simulated_ports.h"

namespace thermorig::app {

namespace {

using rig::SetupStep;

constexpr double shown_s = 3.0;

/// The ports of this computer and the person at its terminal.
class TerminalSetup : public rig::SetupWorld {
 public:
  TerminalSetup(const SetupOptions& options, std::vector<std::string> ports)
      : options_(options), ports_(std::move(ports)) {}

  std::vector<rig::PortFinding> listen() override {
    std::vector<std::string> there;
    for (const std::string& port : ports_)
      if (std::filesystem::exists(port)) there.push_back(port);
    const std::vector<io::PortInfo> ports =
        there.empty() && !ports_.empty() ? std::vector<io::PortInfo>() : ports_to_hear(there);
    if (ports.empty())
      throw Error(ExitCode::device_missing, "this machine has no serial port", "",
                  "plug the devices in; without hardware: thermorig setup --simulated");
    say(fmt::format("listening to {} port{} for up to 6 s ...\n", ports.size(),
                    ports.size() == 1 ? "" : "s"));
    return rig::identify_devices(ports);
  }

  void show(const RigProfile& profile) override {
    rig::PortOptions options;
    options.recording = recording_of(profile);
    std::optional<TimedFrame> frame;
    std::vector<std::string> lines;
    bool is_seen = false;
    options.recording.observe = [&](const Measurement& measurement, HostTime) {
      frame = measurement.frame;
      return std::optional<EstimateRow>();
    };
    options.progress = [&](const rig::RecordingProgress& progress) {
      if (!is_seen) lines = status_lines(progress);
      is_seen = progress.heard_s >= shown_s;
    };
    options.orders = [&] {
      return is_seen ? std::vector<rig::Order>{{rig::OrderKind::stop, "the setup"}}
                     : std::vector<rig::Order>{};
    };
    bool is_stopped = false;
    options.notice = [&](const std::string&) { is_stopped = true; };  // said of a signal alone
    const rig::RecordingResult result = rig::record_ports(options);
    if (is_stopped) throw Error(ExitCode::interrupted, "stopped", "setup", "");
    if (result.exit != ExitCode::interrupted)
      throw Error(result.exit, result.message, "setup", result.advice);
    if (frame && escapes_allowed(stdout))
      print("{}", half_blocks(frame->frame, profile.camera.mirrored, terminal_colours()));
    for (std::size_t i = 0; i < std::min<std::size_t>(lines.size(), device_count); ++i)
      print("{}\n", lines[i]);
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

  void say(const std::string& text) override {
    print("{}", text);
    flush_output();
  }

  void confirm(const std::string& question) override {
    if (options_.yes) return say(question + " (--yes)\n");
    say(question + " [Enter: yes, n: no] ");
    if (const std::string answer = answered();
        !answer.empty() && answer.front() != 'y' && answer.front() != 'Y')
      throw Error(ExitCode::interrupted, "answered with no: nothing was written", "setup",
                  "mend what is not right, then thermorig setup again");
  }

  void ask_to(const std::string& request) override {
    if (options_.yes)
      throw Error(ExitCode::device_missing,
                  request + ": that takes a person, and --yes says that there is none", "setup",
                  "name the rig's ports: thermorig setup PORT PORT PORT");
    say(request + ", then press Enter. ");
    answered();
  }

  bool flash(const std::string& port) override {
    if (!options_.flash) return false;
    if (!servo_firmware_image())
      throw Error(ExitCode::failed,
                  "the firmware's image, servo_firmware.hex, did not come with this program", "setup",
                  "build it: firmware_servo/README.md; then setup without --flash");
    for (const std::string& command : rig::flash_commands(shell_word(port), shell_word(firmware_image()))) {
      say(command + "\n");
      if (std::system(command.c_str()) == 0) return true;
    }
    throw Error(ExitCode::failed, "avrdude could not flash the board, with neither boot loader", port,
                "is it an Uno or a Nano (ATmega328P), and is avrdude installed? apt-get install avrdude");
  }

  std::string firmware_image() const override {
    return servo_firmware_image().value_or("servo_firmware.hex").string();
  }

 private:
  static std::string answered() {
    std::string answer;
    if (!std::getline(std::cin, answer))
      throw Error(ExitCode::interrupted, "the terminal gave no answer: nothing was written", "setup", "");
    return answer;
  }

  rig::RecordingOptions recording_of(const RigProfile& profile) const {
    rig::RecordingOptions recording;
    recording.environment = calibration_environment;
    recording.profile = profile;
    recording.keep = false;
    recording.wait_for_start = true;
    recording.preflight = rig::PreflightMode::warn;
    return recording;
  }

  const SetupOptions& options_;
  std::vector<std::string> ports_;
};

void check_words(const SetupOptions& options, SetupStep from) {
  if (options.record.rig.simulated_seed && !options.ports.empty())
    throw Error(ExitCode::bad_usage, "--simulated and ports exclude each other", "", "one of the two");
  if (from != SetupStep::ports && options.record.rig.simulated_seed)
    throw Error(ExitCode::bad_usage, "a simulated rig has other ports each time", "", "leave --from out");
  if (options.yes || (isatty(STDIN_FILENO) != 0 && isatty(STDOUT_FILENO) != 0)) return;
  throw Error(ExitCode::bad_usage, "setup asks questions, and there is no terminal to answer on", "",
              "--yes answers each with yes; the servo then moves without being asked");
}

/// Which step made what the verdict complains of.
std::string repeat_advice(const session::Quality& quality) {
  const auto mentions = [&](const char* word) {
    return std::any_of(quality.verdict_reasons.begin(), quality.verdict_reasons.end(),
                       [&](const std::string& reason) { return reason.find(word) != std::string::npos; });
  };
  if (mentions("messages were lost") || mentions("sent nothing")) return "thermorig setup --from ports";
  if (mentions("shaft") || mentions("disagree")) return "thermorig setup --from servo";
  return "thermorig setup --from turns";
}

/// The checks, and a session whose verdict says whether all of it is right.
ExitCode prove(const SetupOptions& options, const RigProfile& profile, const std::string& saved) {
  print("\n5 of 5: session\n");
  DoctorOptions doctor{options.record};
  doctor.record.plan = "quick";
  doctor.record.rig = RigOptions();
  doctor.record.rig.profile = saved;
  if (const ExitCode exit = run(doctor); exit != ExitCode::ok) return exit;
  RecordOptions record = doctor.record;
  const ChosenRig rig{profile, std::nullopt};
  const RecordSummary summary =
      record_session(record, rig, rig::load_plan("quick", record.environment, 1, {}));
  print_summary(summary, false);
  require_told(summary);
  const session::Quality& quality = summary.result.quality;
  if (summary.result.exit == ExitCode::ok && quality.verdict == "good")
    print("the rig is ready  thermorig record --environment kitchen --rig {}\n", printable(saved));
  else
    print("not yet good  {} --save {}\n", repeat_advice(quality), printable(saved));
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
    print("SIMULATED rig, seed {}\n", *options.record.rig.simulated_seed);
  }
  TerminalSetup world(options, ports);
  const RigProfile profile = rig::set_up(path, from, world);
  return prove(options, profile, options.save);
}

}  // namespace thermorig::app
