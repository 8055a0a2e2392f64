// SPDX-License-Identifier: MIT
#include "options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "command_texts.h"
#include "completion.h"
#include "help_formatter.h"
#include "learning_options.h"
#include "live/live_options.h"
#include "print/help_text.h"
#include "print/terminal_width.h"
#include "rig_options.h"
#include "sessions/session_options.h"
#include "thermorig/core/error.h"
#include "thermorig/core/nearest_name.h"
#include "thermorig/rig/setup/setup.h"
#include "thermorig/sensors/camera_protocol.h"
#include "thermorig/sensors/gyro_sketch.h"
#include "thermorig/sensors/servo_protocol.h"

namespace thermorig::app {

namespace {

/// Everything that may be on the command line. CLI11 writes into it while it parses.
struct Words {
  RecordOptions record;
  DoctorOptions doctor;
  CalibrateOptions calibrate;
  SetupOptions setup;
  PortsOptions ports;
  LookOptions look;
  SimulateOptions simulate;
  InspectOptions inspect;
  ViewOptions view;
  ListOptions list;
  AnnotateOptions annotate;
  DatasetOptions dataset;
  RecoverOptions recover;
  ReprocessOptions reprocess;
  DecodeOptions decode;
  TrainOptions train;
  EvaluateOptions evaluate;
  LiveCommandLine live;
  ExportOptions export_;
  std::string calibration, decode_device;
  bool version = false, version_json = false;
};

/// How a recording of this command is kept, and what may stop it.
void add_recording_of(CLI::App& command, RecordOptions& record, const std::function<void()>& add_facts) {
  in_group(command, "Session", [&] {
    add_folder(command, record.output, "Folder of the recordings");
    command
        .add_option("--licence", record.licence, "Licence of the data, saved in the session, e.g. CC-BY-4.0")
        ->type_name("TEXT");
    add_facts();
    add_sync(command, record.sync_ms);
  });
  in_group(command, "Checks and faults", [&] {
    command.add_flag("-n,--dry-run", record.dry_run, "Print the plan and the checks; move and write nothing");
    command.add_flag("!--no-preflight", record.preflight, "Record despite failed checks (warn only)");
    add_replug(command, record.replug_patience_s);
  });
  add_json(command, record.json);
}

void add_fast(CLI::App& command, RecordOptions& record) {
  command.add_flag("--fast", record.fast, "As fast as the computer can (with --simulated)");
}

void add_record_page(CLI::App& command, PageOptions& options) {
  CLI::Option* page =
      command.add_flag("--page", options.serve, "Show the recording on a page, for a browser");
  add_page(command, options);
  command.get_option("--page-port")->needs(page);
  command.get_option("--new-token")->needs(page);
}

void add_record(CLI::App& root, Words& words) {
  RecordOptions& record = words.record;
  CLI::App& command = *root.add_subcommand("record", "Record one labelled session");
  add_environment(command, record.environment).required();
  add_fast(command, record);
  in_group(command, "Sweep plan", [&] {
    add_plan(command, record);
    add_legs(command, record, "the plan's");
    add_seconds(command, record);
    command
        .add_option(
            "--frames-per-window", record.frames_per_window,
            "Refuse speeds at which the servo's travel is too short for N valid frames in a row (1 to 6)")
        ->check(within(1, 6))
        ->type_name("N");
  });
  add_rig(command, record.rig);
  add_recording_of(command, record, [&] {
    command.add_option("--operator", record.operator_name, "Who records, saved in the session")
        ->type_name("TEXT");
    command.add_option("--place", record.place, "Where exactly the rig stands, saved in the session")
        ->type_name("TEXT");
    command.add_option("--note", record.note, "A note on this recording, saved in the session")
        ->type_name("TEXT");
  });
  in_group(command, "Checks and faults", [&] {
    command.add_flag("--check", record.check,
                     "First run `calibrate check`; record only if the profile holds");
  });
  in_group(command, "Page", [&] { add_record_page(command, record.page); });
  command.footer(
      "Examples:\n"
      "  thermorig record --simulated=4 --environment garden --plan quick\n"
      "  thermorig record --rig bench --environment kitchen\n"
      "  thermorig record --rig bench --environment kitchen --no-servo --seconds 120");
}

void add_setup(CLI::App& root, Words& words) {
  SetupOptions& setup = words.setup;
  RecordOptions& record = setup.record;
  record.environment = "setup";
  CLI::App& command = *root.add_subcommand("setup", "Set up a new rig and write its profile");
  command.add_option("PORT", setup.ports, "Ports of the rig (default: all that the system lists)");
  command.add_option("--save", setup.save, "Profile to write, when all is known: a name or a file")
      ->type_name("PROFILE")
      ->capture_default_str();
  command.add_option("--from", setup.from, "Go on with this step and the profile that is there")
      ->check(one_of({rig::setup_step_names.begin(), rig::setup_step_names.end()}))
      ->type_name("STEP");
  command.add_flag("--yes", setup.yes, "Answer each question with yes: the servo moves without being asked");
  command.add_flag("--flash", setup.flash, "Flash the servo's firmware (avrdude) where no servo answers");
  add_json(command, record.json);
  add_folder(command, record.output, "Folder that holds the recordings");
  add_seed(
      command, [&record](std::uint64_t seed) { record.rig.simulated_seed = seed; },
      "Set up the simulated rig; =SEED chooses another one");
  in_group(command, simulated_rig_group, [&] { add_simulated_parts(command, record.rig.parts); });
  command.footer(
      "Steps: ports, look, servo, turns, session.\n"
      "Examples:\n"
      "  thermorig setup --save bench\n"
      "  thermorig setup --save bench --from turns");
}

void add_doctor(CLI::App& root, Words& words) {
  RecordOptions& record = words.doctor.record;
  record.environment = "laboratory";
  CLI::App& command = *root.add_subcommand("doctor", "Check whether this computer and its rig can record");
  add_folder(command, record.output, "Folder for the recordings");
  add_plan(command, record);
  add_json(command, record.json);
  add_rig(command, record.rig);
  command.footer(
      "Moves nothing. Exit code 0 if nothing is NOT OK, else that of the first check that is.\n"
      "Examples:\n"
      "  thermorig doctor\n"
      "  thermorig doctor --rig bench --plan paper");
}

void add_calibrate(CLI::App& root, Words& words) {
  CalibrateOptions& calibrate = words.calibrate;
  CLI::App& command = *root.add_subcommand("calibrate", "Measure the rig's constants and save them");
  command
      .add_option(
          "WHAT", words.calibration,
          "bias (of the gyro, 60 s at rest), latency (of the camera), scale (of gyro and servo), "
          "orientation (axes and signs), lens (where each pixel looks), encoder (on the shaft), or check "
          "(does the profile still hold?)")
      ->check(one_of({calibration_names.begin(), calibration_names.end()}))
      ->required();
  command
      .add_option("--session", calibrate.sessions,
                  "Measure on these sessions (.h5, or folders of them) instead of recording one")
      ->type_name("PATH");
  command.add_option("--save", calibrate.save, "Profile to write: a name or a file (default: that of --rig)")
      ->type_name("PROFILE");
  command.add_flag("--marks", calibrate.marks,
                   "For scale: you turn the rig by hand between two marks; images are not used");
  command.add_option("--angle", calibrate.angle_deg, "For scale: degrees between the marks (default 360)")
      ->type_name("DEG");
  calibrate.record.environment = calibration_environment;
  add_fast(command, calibrate.record);
  add_rig(command, calibrate.record.rig);
  add_recording_of(command, calibrate.record, [] {});
  command.footer(
      "Examples:\n"
      "  thermorig calibrate latency --rig bench\n"
      "  thermorig calibrate scale --simulated=4 --fast --save simulated.toml\n"
      "  thermorig calibrate check --rig bench");
}

void add_ports(CLI::App& root, Words& words) {
  CLI::App& command = *root.add_subcommand("ports", "Find camera, gyro and servo by listening to every port");
  command.add_option("PORT", words.ports.extra, "Listen to these ports only (default: every serial port)");
  command.add_option("--save", words.ports.save, "Save what was found as a profile: a name or a file")
      ->type_name("PROFILE");
  add_json(command, words.ports.json);
  command.footer("Example:\n  thermorig ports --save bench");
}

void add_look(CLI::App& root, Words& words) {
  CLI::App& command = *root.add_subcommand("look", "Show live what one device sends");
  command.add_option("PORT", words.look.port, "Port of the device (default: the only one that is found)");
  command.add_option("--seconds", words.look.seconds, "Stop after so many seconds (default: at Ctrl-C)")
      ->check(not_negative())
      ->type_name("S");
  add_json(command, words.look.json);
  command.footer(
      "Shows a camera's image, a gyro's rates and turned angles, a servo's firmware and angle.\n"
      "Nothing moves. Examples:\n"
      "  thermorig look\n"
      "  thermorig look /dev/ttyUSB1");
}

void add_simulate(CLI::App& root, Words& words) {
  SimulateOptions& simulate = words.simulate;
  CLI::App& command = *root.add_subcommand("simulate", "Run a simulated rig on three virtual ports");
  command.add_option("--seed", simulate.seed, "Seed of the simulated rig")
      ->check(not_negative())
      ->capture_default_str();
  add_seed(
      command, [&simulate](std::uint64_t seed) { simulate.seed = seed; },
      "The same, as other commands have it");
  command
      .add_option("-e,--environment", simulate.environment,
                  "Where the rig stands; laboratory, dining, kitchen and garden have a scene of their own")
      ->type_name("NAME")
      ->capture_default_str();
  command
      .add_option("--profile", simulate.profile, "Write a profile of the three ports to this file, for --rig")
      ->type_name("FILE");
  in_group(command, simulated_rig_group, [&] { add_simulated_parts(command, simulate.parts); });
  add_json(command, simulate.json);
  command.footer("Example:\n  thermorig simulate --seed 3 --environment garden --profile simulated.toml");
}

void add_inspect(CLI::App& root, Words& words) {
  CLI::App& command = *root.add_subcommand("inspect", "Describe sessions and maps: contents, rates, verdict");
  command
      .add_option("PATH", words.inspect.paths,
                  "Session files (.h5), folders of them, or maps of `live --map`")
      ->required();
  command.add_flag("--timing", words.inspect.timing,
                   "Show how well times and labels are known: clocks, offsets, scales, residuals");
  command.add_flag("--check", words.inspect.check,
                   "Exit with code 9 if a verdict is bad, or a file was altered");
  command
      .add_option("--html", words.inspect.html,
                  "Write the page that `view` serves, with the session in it, to this file (5 MB at most)")
      ->type_name("FILE");
  command
      .add_option("--plots", words.inspect.plots,
                  "Write figures (SVG, PDF, PNG) and tables (LaTeX, CSV) to this empty folder; of several "
                  "sessions to a folder each in it")
      ->type_name("DIR");
  add_json(command, words.inspect.json);
  command.footer(
      "Examples:\n"
      "  thermorig inspect session.h5 --plots plots\n"
      "  thermorig inspect --check recordings/garden\n"
      "  thermorig inspect kitchen.map");
}

void add_view(CLI::App& root, ViewOptions& view) {
  CLI::App& command = *root.add_subcommand("view", "Show a session in the browser: images, rates, validity");
  command.add_option("SESSION", view.file, "Session file (.h5), or a folder to choose one from")->required();
  command.add_option("--page-port", view.port, "Port of the page on this computer (0: any free one)")
      ->check(within(0, 65535))
      ->type_name("N")
      ->capture_default_str();
  add_json(command, view.json);
  command.footer(
      "Examples:\n"
      "  thermorig view session.h5\n"
      "  thermorig view recordings/garden");
}

void add_recover(CLI::App& root, Words& words) {
  CLI::App& command = *root.add_subcommand("recover", "Rebuild sessions after a crash");
  command
      .add_option("PATH", words.recover.path,
                  "A journal, a session that was cut short, or a folder to search")
      ->required();
  add_json(command, words.recover.json);
  command.footer("Example:\n  thermorig recover recordings");
}

void add_reprocess(CLI::App& root, Words& words) {
  CLI::App& command = *root.add_subcommand("reprocess", "Rebuild sessions from their raw data");
  command
      .add_option("PATH", words.reprocess.paths,
                  "Session files (.h5), or folders of them; each session is replaced")
      ->required();
  command
      .add_option("--rig", words.reprocess.profile,
                  "Apply the later calibrations of this profile: a name or a file")
      ->type_name("PROFILE");
  add_json(command, words.reprocess.json);
  command.footer("Example:\n  thermorig reprocess recordings/garden");
}

void add_text_gyro(CLI::App& command, DecodeOptions& decode) {
  command
      .add_option("--columns", decode.columns, "Columns of x, y and z, from 0; -1: not sent (default 0,1,2)")
      ->delimiter(',')
      ->type_name("X,Y,Z");
  command.add_option("--prefix", decode.prefix, "Text at the start of each line")->type_name("TEXT");
  command.add_option("--scale", decode.scale_dps, "Value of one unit in deg/s")
      ->type_name("DPS")
      ->capture_default_str();
  command.add_option("--time-column", decode.time_column, "Column of the gyro's own time; -1: none")
      ->type_name("N")
      ->capture_default_str();
  command.add_option("--time-unit", decode.time_unit_s, "Seconds of one unit of that time")
      ->type_name("S")
      ->capture_default_str();
}

void add_decode(CLI::App& root, Words& words) {
  DecodeOptions& decode = words.decode;
  CLI::App& command = *root.add_subcommand("decode", "Decode a file of a device's raw bytes");
  command.add_option("--device", words.decode_device, "Device that sent the bytes")
      ->check(one_of({"camera", "gyro", "servo"}))
      ->type_name("DEVICE")
      ->required();
  command.add_option("FILE", decode.file, "File of raw bytes; - for standard input")->required();
  command.add_option("--lines", decode.lines, "Messages to print (default 10, with --json all)")
      ->check(not_negative())
      ->type_name("N");
  command.add_flag("--all", decode.all, "Print every message");
  in_group(command, "Protocol", [&] {
    command
        .add_option("--camera-protocol", decode.camera_protocol, "Protocol of the camera (default: detected)")
        ->check(one_of(sensors::camera_protocol_names()))
        ->type_name("NAME");
    command
        .add_option("--camera-checksum", decode.camera_checksum,
                    "Checksum of the camera: of words, of bytes, or ignored")
        ->check(one_of({"word", "byte", "ignore"}))
        ->type_name("KIND")
        ->capture_default_str();
    command
        .add_option("--gyro-protocol", decode.gyro_protocol,
                    "Protocol of the gyro, or the sketch whose lines it prints: xsens, adafruit-mpu6050, ... "
                    "(default: detected)")
        ->check(known_name(sensors::gyro_names()))
        ->type_name("NAME");
    command
        .add_option("--servo-protocol", decode.servo_protocol, "Protocol of the servo (default: detected)")
        ->check(one_of(sensors::servo_protocol_names()))
        ->type_name("NAME");
    command
        .add_option("--gyro-setting", decode.gyro_settings,
                    "Setting of the protocol, as in a profile: raw_scale_dps=0.0573; may be repeated")
        ->type_name("NAME=NUMBER");
  });
  in_group(command, "Gyro that sends text", [&] { add_text_gyro(command, decode); });
  add_json(command, decode.json);
  command.footer("Example:\n  thermorig decode --device camera dump.bin");
}

Device device_of(const std::string& name) {
  for (Device device : all_devices)
    if (name == name_of(device)) return device;
  throw Error(ExitCode::bad_usage, "'" + name + "' is not a device", "", "camera, gyro or servo");
}

rig::CalibrationKind calibration_of(const std::string& name) {
  const auto found = std::find(calibration_names.begin(), calibration_names.end(), name);
  return static_cast<rig::CalibrationKind>(found - calibration_names.begin());
}

Command chosen(const CLI::App& root, Words& words) {
  if (words.version) return VersionOptions{words.version_json};
  const std::string& name = root.get_subcommands().front()->get_name();
  if (name == "calibrate") {
    words.calibrate.kind = calibration_of(words.calibration);
    return words.calibrate;
  }
  if (name == "decode") {
    words.decode.device = device_of(words.decode_device);
    if (words.decode.columns.size() != 3)
      throw Error(ExitCode::bad_usage, "--columns takes three numbers: those of x, y and z", "",
                  "--columns 0,1,2; -1 for an axis that is not sent");
    return words.decode;
  }
  if (name == "record") return words.record;
  if (name == "doctor") return words.doctor;
  if (name == "simulate") return words.simulate;
  if (name == "setup") return words.setup;
  if (name == "ports") return words.ports;
  if (name == "look") return words.look;
  if (name == "live") return chosen_live(words.live);
  if (name == "inspect") return words.inspect;
  if (name == "view") return words.view;
  if (name == "list") return words.list;
  if (name == "annotate") return words.annotate;
  if (name == "dataset") return words.dataset;
  if (name == "recover") return words.recover;
  if (name == "train") return words.train;
  if (name == "evaluate") return words.evaluate;
  if (name == "export") return words.export_;
  return words.reprocess;
}

using CommandGroup = std::pair<const char*, std::vector<const char*>>;

void group_commands(CLI::App& root, const std::vector<CommandGroup>& groups) {
  for (const auto& [group, names] : groups)
    for (const char* name : names) root.get_subcommand(name)->group(group);
}

void describe(CLI::App& root, Words& words) {
  root.description(
      "Records a thermal camera, a gyro and a servo on three serial ports into labelled HDF5 sessions, "
      "trains a "
      "network on them and shows it live. Everything works without hardware: --simulated stands for a whole "
      "rig.");
  const auto formatter = std::make_shared<HelpFormatter>();
  formatter->label("Positionals", "Arguments");
  formatter->label("SUBCOMMAND", "COMMAND");
  root.formatter(formatter);
  root.require_subcommand(0, 1);
  root.add_flag("--version", words.version, "Print version, commit, compiler and libraries")
      ->group(last_group);
  add_json(root, words.version_json);
  add_setup(root, words);
  add_record(root, words);
  add_live(root, words.live);
  add_calibrate(root, words);
  add_doctor(root, words);
  add_ports(root, words);
  add_look(root, words);
  add_simulate(root, words);
  add_list(root, words.list);
  add_inspect(root, words);
  add_view(root, words.view);
  add_annotate(root, words.annotate);
  add_dataset(root, words.dataset);
  add_recover(root, words);
  add_reprocess(root, words);
  add_decode(root, words);
  add_train(root, words.train);
  add_evaluate(root, words.evaluate);
  add_export(root, words.export_);
  group_commands(
      root,
      {{"Rig", {"setup", "ports", "look", "doctor", "calibrate", "simulate"}},
       {"Record", {"record", "live"}},
       {"Sessions", {"list", "inspect", "view", "annotate", "dataset", "recover", "reprocess", "decode"}},
       {"Network", {"train", "evaluate", "export"}}});
  put_help_last(root);
  take_one_word_each(root);
  // A shell writes out *.h5, and no file of another kind follows.
  root.get_subcommand("calibrate")->get_option("--session")->allow_extra_args();
  root.footer(
      "Help on a command: thermorig help COMMAND, or man thermorig-COMMAND\n"
      "First steps:\n"
      "  thermorig record --simulated=4 --environment laboratory --plan quick\n"
      "  thermorig ports");
}

/// What may stand in place of `slip`: options of the command, or commands of its own. Where it has none, a
/// word without dashes may be an option as well.
std::vector<std::string> words_like(const std::string& slip, const CLI::App& command) {
  std::vector<std::string> words;
  if (!slip.starts_with('-'))
    for (const CLI::App* one : command.get_subcommands(nullptr)) words.push_back(one->get_name());
  if (!words.empty()) return words;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) words.push_back("--" + name);
  return words;
}

/// An option of a former version, and what to write in its place.
struct GoneOption {
  std::string_view command, name, instead;
};

constexpr std::array<GoneOption, 3> options_that_are_gone{
    {{"export", "--odometer",
      "the odometer runs on a computer (thermorig live); for a board there is the network: export MODEL "
      "--c-header"},
     {"train", "--cache",
      "frames that memory has no room for lie beside the output: write that to a large disk, or allow more "
      "--memory"},
     {"evaluate", "--job",
      "trainings at the same time: --jobs N; one part of N of a study: --shard I/N; --list-jobs shows which "
      "jobs are open"}}};

/// That was named last, "dataset build"; else `root`.
const CLI::App& innermost(const CLI::App& root) {
  const std::vector<CLI::App*> named = root.get_subcommands();
  return named.empty() ? root : innermost(*named.front());
}

std::string what_to_read(const CLI::App& root) {
  const std::vector<std::string> left = root.remaining(true);
  const CLI::App* command = &innermost(root);
  std::string help = "--help";
  for (const CLI::App* one = command; one != nullptr; one = one->get_parent())
    help = (one == &root ? "thermorig" : one->get_name()) + " " + help;
  if (left.empty()) return help;
  const std::string slip = left.front().substr(0, left.front().find('='));
  for (const auto& [owner, name, instead] : options_that_are_gone)
    if (command->get_name() == owner && slip == name) return std::string(instead);
  const auto meant = nearest_name(slip, words_like(slip, *command));
  return (meant ? "did you mean " + *meant + "? " : "") + help;
}

std::string unexpected_text(const CLI::App& root) {
  const std::string word = root.remaining(true).front();
  if (word.starts_with("-")) return "there is no option " + word;
  const CLI::App& command = innermost(root);
  return named_commands(command).empty() ? "\"" + word + "\" was not expected"
                                         : "there is no command \"" + word + "\"";
}

/// `what` is CLI11's text.
std::string missing_text(const CLI::App& root, const std::string& what) {
  return named_commands(innermost(root)).empty() ? what : "a command is missing";
}

/// "--speeds = 30deg" of CLI11's "Could not convert: --speeds = 30deg".
std::string conversion_text(const std::string& what) {
  const std::string begin = "Could not convert: ";
  return what.starts_with(begin) ? what.substr(begin.size()) + " is not a number" : what;
}

/// What is made of the commands for others than their user: `complete WORD...`, which shells call; `help
/// --man DIR`, which the build calls; `help --tables`, which is in docs/commands.md. Nothing: the words are a
/// user's.
std::optional<CommandLine> texts_of_commands(const CLI::App& root, const std::vector<std::string>& words) {
  if (words.empty()) return std::nullopt;
  if (words.front() == "complete")
    return CommandLine{{}, completions(root, {words.begin() + 1, words.end()})};
  if (words.front() != "help" || words.size() < 2) return std::nullopt;
  if (words[1] == "--tables") return CommandLine{{}, option_tables(root)};
  if (words[1] == "--man" && words.size() == 3)
    return CommandLine{ManPagesOptions{words[2], man_pages(root)}, ""};
  return std::nullopt;
}

/// `thermorig help record` is `thermorig record --help`; of a command that there is not, the name is wrong.
void take_help_as_option(CLI::App& root, std::vector<std::string>& words) {
  if (words.empty() || words.front() != "help") return;
  words.erase(words.begin());
  CLI::App* command = &root;
  for (const std::string& word : words) {
    if (named_commands(*command).empty()) break;
    if (command = command_in(*command, {word}); command == nullptr) return;
  }
  words.push_back("--help");
}

/// "--plan is given 2 times" of CLI11's "--plan: At Most 1 required but received 2".
std::string mismatch_text(const std::string& what) {
  const std::string middle = ": At Most 1 required but received ";
  const std::size_t at = what.find(middle);
  if (at == std::string::npos) return what;
  return what.substr(0, at) + " is given " + what.substr(at + middle.size()) + " times";
}

/// An empty word mostly comes of a shell's variable that is not set, and would be taken for one that was not
/// said. No option means anything by it.
void refuse_empty_words(int argc, const char* const* argv) {
  const auto refuse = [](const std::string& what, const std::string& name) {
    throw Error(ExitCode::bad_usage, what + " is empty", "",
                "give " + name + " a value, or leave it out (is a variable of the shell not set?)");
  };
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i], before = argv[i - 1];
    if (word.empty() && before.starts_with("-")) refuse("the value of " + before, before);
    if (word.empty()) refuse("word " + std::to_string(i) + " of the command line", "it");
    if (!word.starts_with("--") || word.find('=') != word.size() - 1) continue;
    const std::string name = word.substr(0, word.size() - 1);
    refuse("the value of " + name, name);
  }
}

}  // namespace

CommandLine parse(int argc, const char* const* argv) {
  Words words;
  CLI::App root("", "thermorig");
  describe(root, words);
  std::vector<std::string> said(argv + 1, argv + argc);
  if (auto texts = texts_of_commands(root, said)) return *texts;
  refuse_empty_words(argc, argv);
  take_help_as_option(root, said);
  join_values(root, said);
  std::reverse(said.begin(), said.end());  // as CLI11 takes them
  try {
    root.parse(std::move(said));
  } catch (const CLI::CallForHelp&) {
    return {std::nullopt, help_text(root.help(), terminal_width())};
  } catch (const CLI::RequiredError& error) {
    // A word that is left is mostly a slip of the pen, in the one that is missing.
    throw Error(ExitCode::bad_usage,
                root.remaining(true).empty() ? missing_text(root, error.what()) : unexpected_text(root), "",
                what_to_read(root));
  } catch (const CLI::ExtrasError&) {
    throw Error(ExitCode::bad_usage, unexpected_text(root), "", what_to_read(root));
  } catch (const CLI::ConversionError& error) {
    throw Error(ExitCode::bad_usage, conversion_text(error.what()), "", what_to_read(root));
  } catch (const CLI::ParseError& error) {
    throw Error(ExitCode::bad_usage, mismatch_text(error.what()), "", what_to_read(root));
  }
  if (!words.version && root.get_subcommands().empty())
    throw Error(ExitCode::bad_usage, "a command is missing", "", "thermorig --help");
  return {chosen(root, words), ""};
}

}  // namespace thermorig::app
