// SPDX-License-Identifier: MIT
#include <CLI/CLI.hpp>

#include "help_formatter.h"
#include "learning_options.h"
#include "rig_options.h"
#include "thermorig/learning/interchange/table.h"

namespace thermorig::app {

namespace {

void add_c_sources(CLI::App& command, ExportOptions& options) {
  CLI::Option* c_header = command.add_flag("--c-header", options.c_header,
                                           "Model as C99 sources: NAME.h, NAME.c and NAME_weights.h");
  command.add_option("--weights", options.weights, "Weights of the model's C sources: float32 or int8")
      ->check(one_of({"float32", "int8"}))
      ->type_name("KIND")
      ->capture_default_str()
      ->needs(c_header);
  command
      .add_option("--name", options.name, "Prefix of the C files and symbols (default: thermorig_network)")
      ->type_name("NAME");
}

/// Which there are, the session says: a name that may be one, and is no file's.
std::string problem_of_trajectory(const std::string& name) {
  return name.find_first_of("./") == std::string::npos ? "" : name + " is not a trajectory";
}

void add_session_forms(CLI::App& command, ExportOptions& options) {
  command
      .add_flag("--npz{windows}", options.npz,
                "NumPy arrays: windows (as `train` sees them, default), or rows (one a frame)")
      ->check(one_of({"windows", "rows"}))
      ->type_name("WHAT");
  add_window_shape(command, options.frames, options.reduction);
  command
      .add_flag("--csv{samples}", options.csv,
                "Table as CSV: samples (default), camera, gyro, servo, estimates, events")
      ->check(one_of(interchange::table_names()))
      ->type_name("TABLE");
  command
      .add_flag("--tum{all}", options.tum,
                "Trajectories for evo: all (shaft, also as measured, and estimators; default), or NAME")
      ->check(CLI::Validator(problem_of_trajectory, ""))
      ->type_name("NAME");
  command
      .add_flag("--mcap{none}", options.mcap,
                "Everything for Foxglove as MCAP; compression: none (default), zstd")
      ->check(one_of({"none", "zstd"}))
      ->type_name("HOW");
}

}  // namespace

void add_export(CLI::App& root, ExportOptions& options) {
  CLI::App& command =
      *root.add_subcommand("export", "Export sessions and models for other programs and boards");
  command.add_option("FILE", options.file, "Session (.h5) or folder of sessions, or model (.onnx)")
      ->required();
  command
      .add_option("-o,--output", options.output,
                  "Folder to write to (default: this one); for a session also -, standard output")
      ->type_name("DIR");
  in_group(command, "Forms of a session", [&] { add_session_forms(command, options); });
  in_group(command, "Forms of a model", [&] {
    command
        .add_option("--batch", options.batch,
                    "ONNX with a fixed batch of N, for engines that need one (1 to 65536)")
        ->check(within(1, 65'536))
        ->type_name("N");
  });
  in_group(command, "C sources for small boards", [&] { add_c_sources(command, options); });
  add_json(command, options.json);
  command.footer(
      "Examples:\n"
      "  thermorig export session.h5 --npz --nf 3 --mcap -o exported\n"
      "  thermorig export session.h5 --csv=gyro -o - | head\n"
      "  thermorig export model.onnx --c-header --weights int8 -o firmware/src");
}

}  // namespace thermorig::app
