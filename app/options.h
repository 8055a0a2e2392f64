// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "thermorig/core/device.h"
#include "thermorig/rig/sweep/plan.h"

namespace thermorig::app {

/// What a simulated rig differs in from the default one.
struct SimulatedParts {
  std::optional<std::string> servo;          // winch (default), 180, 270, continuous
  std::optional<std::string> camera;         // half (default), full: fresh halves a frame
  std::optional<std::string> gyro;           // calibrated, typical (default), raw: bias and scale
  std::optional<std::string> gyro_protocol;  // or a sketch; none: the profile's
  std::optional<std::string> encoder;        // none (default), as5600
  std::optional<std::string> scene;          // what the camera sees; none: the environment's own
  std::optional<std::string> world;          // as simulation::world_named() takes it; none: the default one
};

/// Which rig: a simulated one, three ports, or a profile; and what differs from its defaults.
struct RigOptions {
  std::optional<std::uint64_t> simulated_seed;  // none: real ports
  PerDevice<std::string> ports;                 // empty: from the profile
  std::string profile;                          // name or file, empty: none
  SimulatedParts parts;
  std::string gyro_protocol;   // or a sketch; empty: the profile's
  std::string servo_protocol;  // empty: the profile's
  std::optional<std::uint32_t> camera_baud, gyro_baud, servo_baud;
  std::optional<double> camera_rate_hz;
  bool no_servo = false;  // nobody commands what turns the rig, whatever the profile says
};

/// The page that a running command serves.
struct PageOptions {
  bool serve = false;
  std::uint16_t port = 8650;
  bool new_token = false;
  bool control = false;  // the page may start motion, and motion waits for it
};

struct RecordOptions {
  RigOptions rig;
  std::string environment;
  std::filesystem::path output = "recordings";
  std::string licence;                     // of the data; empty: not stated
  std::string operator_name, place, note;  // of this recording; empty: not stated
  std::string plan = "paper";              // paper, table-one, quick or a TOML file
  bool plan_is_named = false;
  std::optional<double> seconds;  // of a rig without a servo; none: until it is stopped
  std::optional<int> frames_per_leg, valid_per_leg;
  int frames_per_window = 1;        // valid ones in a row that every speed must be able to give
  std::vector<double> speeds_dps;   // empty: the plan's own
  bool fast = false;                // virtual time
  double replug_patience_s = 60.0;  // a device that goes is waited for so long; 0: the end at once
  int sync_ms = 125;                // a loss of power costs as much
  PageOptions page;
  bool dry_run = false;
  bool preflight = true;  // a rig that is not fit is refused before it moves
  bool check = false;     // whether the profile still holds is seen before it is recorded with
  bool json = false;
};

struct DoctorOptions {
  RecordOptions record;  // rig and plan as of a recording; without a rig the host alone
};

struct LiveOptions {
  RecordOptions record;                         // rig, environment, plan; output where a session is kept
  std::filesystem::path model;                  // empty: the program's own, where it has one; "none"
  bool keep = false;                            // a session, as `record` makes one
  std::string precision = "fp32";               // of the network's weights: fp32, fp16
  std::optional<int> turned;                    // 1, 8; none: 8, where the network has learnt the turns
  std::vector<std::string> estimators;          // by name; empty: all that can run
  bool loop = false;                            // the plan again and again, until it is stopped
  std::filesystem::path map;                    // of the odometer: begun with, and written; empty: none
  std::optional<std::filesystem::path> replay;  // a session instead of a rig
  double speed = 1.0;                           // of a replay; 0: as fast as possible
  bool tui = false;
};

/// In the order of rig::CalibrationKind.
inline constexpr std::array<std::string_view, 7> calibration_names{"bias", "latency", "scale",  "orientation",
                                                                   "lens", "check",   "encoder"};

/// Where sessions of calibrations are kept, beside the environments.
inline constexpr const char* calibration_environment = "calibration";

struct CalibrateOptions {
  rig::CalibrationKind kind = rig::CalibrationKind::bias;
  RecordOptions record;                         // how a session for it is recorded
  std::vector<std::filesystem::path> sessions;  // or folders that hold them; empty: one is recorded
  std::string save;                             // name or file of the profile to write; empty: that of --rig
  bool marks = false;                           // scale: turned between marks, the image is not asked
  std::optional<double> angle_deg;              // between the marks, default 360
};

struct PortsOptions {
  std::vector<std::string> extra;  // ports that the system does not list, e.g. pseudo terminals
  std::string save;                // name or file of the profile to write, empty: none
  bool json = false;
};

struct SetupOptions {
  RecordOptions record;            // the simulated rig, if any; environment and folder of its sessions
  std::vector<std::string> ports;  // those of the rig; empty: all that the system lists
  std::string save = "rig";        // name or file of the profile
  std::string from;                // name of the step to begin with; empty: the first
  bool yes = false;                // each question is answered with yes
  bool flash = false;              // by avrdude, where no servo answers
};

struct LookOptions {
  std::string port;      // empty: the one device that is found
  double seconds = 0.0;  // then it ends; 0: the user ends it
  bool json = false;
};

struct SimulateOptions {
  std::uint64_t seed = 1;
  std::string environment = "laboratory";
  SimulatedParts parts;
  std::string profile;  // file to write, empty: none
  bool json = false;
};

struct InspectOptions {
  std::vector<std::filesystem::path> paths;  // sessions, or folders that hold them
  bool check = false;
  bool timing = false;
  std::filesystem::path plots;  // folder of figures and tables; empty: none
  std::filesystem::path html;   // file that the session's page is written to; empty: it is described
  bool json = false;
};

struct ViewOptions {
  std::filesystem::path file;
  std::uint16_t port = 8651;  // 0: any that is free
  bool json = false;
};

struct ListOptions {
  std::vector<std::filesystem::path> paths{"recordings"};  // folders, or session files
  std::vector<std::string> environments, plans, verdicts;  // only these; empty: all
  bool simulated = false, real = false;                    // only these; neither: all
  std::string sort = "environment";                        // date, verdict, valid
  bool reverse = false;
  bool json = false;
};

struct AnnotateOptions {
  std::filesystem::path file;
  std::optional<std::string> note, environment, exclude;  // one of these, or
  bool undo = false;                                      // the last one is taken back
  std::string reason;                                     // of an exclusion
  bool json = false;
};

enum class DatasetAction : std::uint8_t { build, verify, split };

struct DatasetOptions {
  DatasetAction action = DatasetAction::build;
  std::filesystem::path folder;
  std::string title, description, licence, version = "1.0.0", url, date;  // date empty: today
  std::vector<std::string> authors;
  bool accept_bad = false;  // sessions whose verdict is bad
  bool replace = false;     // the descriptions that are there
  std::string environment;  // of the split that is asked for; empty: all
  std::string part;         // training or test: only its paths
  bool json = false;
};

struct RecoverOptions {
  std::filesystem::path path;
  bool json = false;
};

struct ReprocessOptions {
  std::vector<std::filesystem::path> paths;  // sessions, or folders that hold them
  std::string profile;  // name or file whose calibrations are applied, empty: the session's own
  bool json = false;
};

struct DecodeOptions {
  Device device = Device::camera;
  std::string file;                                            // "-": standard input
  std::string camera_protocol, gyro_protocol, servo_protocol;  // empty: what is recognised
  std::string gyro_sketch;                                     // of lines of text; empty: none named
  std::vector<std::string> gyro_settings;                      // NAME=NUMBER
  std::vector<int> columns{0, 1, 2};
  std::string prefix;
  double scale_dps = 1.0;
  int time_column = -1;
  double time_unit_s = 1e-3;
  std::string camera_checksum = "word";
  std::optional<std::uint64_t> lines;
  bool all = false;
  bool json = false;
};

/// Where the frames of trainings and evaluations lie.
struct FrameOptions {
  std::optional<std::uint64_t> memory_mb;  // none: half of the machine's
};

struct TrainOptions {
  std::vector<std::filesystem::path> paths;  // sessions, or folders that hold them
  std::filesystem::path output = "model.onnx";
  std::filesystem::path run_folder;  // empty: beside the model, named after it
  std::string preset = "best";
  std::string label = "commanded";  // that is learnt: commanded, corrected, shaft
  std::optional<int> frames, reduction, epochs, batch, threads;
  FrameOptions frame_memory;
  std::optional<double> rate, auxiliary_thermal, label_scale_dps;
  std::optional<int> symmetries;
  std::optional<bool> choose_epoch;
  std::string from;         // model file to begin with, or "none"; empty: the general one, where it fits
  bool made_rooms = false;  // alone, or half of each batch beside recordings
  std::optional<double> lens_deg;  // of made-up rooms
  bool fusion = true;
  std::uint64_t seed = 1;
  bool resume = false;
  bool accept_bad = false;  // sessions whose verdict is bad
  bool json = false;
};

struct EvaluateOptions {
  std::filesystem::path model;               // of a model on sessions
  std::vector<std::filesystem::path> paths;  // sessions, or folders that hold them
  bool study = false;                        // the paper's study instead of a model
  bool live = false;                         // what live runs showed instead of a model
  std::filesystem::path output;  // folder of reports, and of a study its results; of a model empty: none
  std::filesystem::path plots;   // folder of figures and tables; empty: none
  std::optional<std::filesystem::path> draw;  // folder of a study: only draw its report again
  std::string environment = "garden";
  std::vector<int> frames{2, 3, 4, 5, 6}, reductions{1, 2, 3};
  std::vector<std::uint64_t> seeds{1}, reference_seeds{1, 2, 3};
  std::string preset = "paper";
  std::optional<std::string> label;  // of a study; none: commanded
  int epochs = 40;
  std::optional<int> history;        // valid frames before a window's end; default: the largest Nf
  std::optional<int> workers;        // jobs side by side; default: cores
  FrameOptions frame_memory;         // of a model or a study
  bool list_jobs = false;            // of a study: only say where its jobs stand
  std::optional<std::string> shard;  // of a study: only a part of its jobs, "3/8"
  bool require_complete = false;     // to draw: only if all jobs of the study have a result
  bool baselines = false;            // of a study: only compute the gyro's rows of its results again
  int turned = 1;                    // of a model on sessions: 8, the mean of each window's eight turns
  bool bound = false;                // of a model on sessions: errors beside the bound of each window
  bool accept_bad = false;           // sessions whose verdict is bad
  bool json = false;
};

struct ExportOptions {
  std::filesystem::path file;            // a session or a model
  std::filesystem::path output = ".";    // folder; of a session also "-"
  std::optional<std::string> npz;        // of a session: windows, rows
  std::optional<int> frames, reduction;  // of its windows
  std::optional<std::string> csv;        // a table of it
  std::optional<std::string> tum;        // all its trajectories, or one by name
  std::optional<std::string> mcap;       // "none" or "zstd": how it is compressed
  bool c_header = false;
  std::string weights = "float32";  // or int8
  std::optional<std::string> name;  // prefix of the C sources
  std::optional<int> batch;         // ONNX with a fixed batch
  bool json = false;
};

struct VersionOptions {
  bool json = false;
};

/// Not in any help: what the build makes its man pages with.
struct ManPagesOptions {
  std::filesystem::path folder;
  std::map<std::string, std::string> pages;  // by file name
};

using Command =
    std::variant<RecordOptions, CalibrateOptions, SetupOptions, PortsOptions, SimulateOptions, InspectOptions,
                 RecoverOptions, ReprocessOptions, DecodeOptions, TrainOptions, EvaluateOptions,
                 ExportOptions, VersionOptions, LiveOptions, DoctorOptions, ListOptions, AnnotateOptions,
                 DatasetOptions, ViewOptions, LookOptions, ManPagesOptions>;

/// What the command line asks for.
struct CommandLine {
  std::optional<Command> command;  // none: `help` is to be printed
  std::string help;
};

/// Throws Error(bad_usage) with the sentence of what is wrong and the help to read.
CommandLine parse(int argc, const char* const* argv);

}  // namespace thermorig::app
