// SPDX-License-Identifier: MIT
#include <CLI/CLI.hpp>

#include "learning_options.h"
#include "rig_options.h"
#include "thermorig/learning/interchange/table.h"

namespace thermorig::app {

namespace {

void add_model_forms(CLI::App& command, ExportOptions& options) {
  CLI::Option* c_header =
      command.add_flag("--c-header", options.c_header,
                       "Model: C99 sources for small boards: NAME.h, NAME.c and NAME_weights.h");
  command.add_option("--weights", options.weights, "Of the C sources: float32 or int8")
      ->check(CLI::IsMember({"float32", "int8"}))
      ->capture_default_str()
      ->needs(c_header);
  command
      .add_flag("--odometer", options.odometer,
                "Profile, or session: the odometer as C99 for small boards: NAME.h, NAME.c and NAME_rig.h")
      ->excludes(c_header);
  command
      .add_option("--name", options.name,
                  "Prefix of the C sources' files and symbols [thermorig_network, thermorig_odometer]")
      ->type_name("NAME");
  command
      .add_option("--batch", options.batch,
                  "Model: ONNX with a fixed batch of N, for engines that ask for one")
      ->check(CLI::Range(1, 65'536))
      ->type_name("N");
}

/// Which there are, the session says: a name that may be one, and is no file's.
std::string problem_of_trajectory(const std::string& name) {
  return name.find_first_of("./") == std::string::npos ? "" : name + " is no name of a trajectory";
}

void add_session_forms(CLI::App& command, ExportOptions& options) {
  command
      .add_flag("--npz{windows}", options.npz,
                "Session: NumPy arrays of the windows that `train` sees; =rows: of the frames, a row each")
      ->check(CLI::IsMember({"windows", "rows"}))
      ->type_name("WHAT");
  add_window_shape(command, options.frames, options.reduction);
  command
      .add_flag("--csv{samples}", options.csv,
                "Session: a table with units in its header: samples, camera, gyro, servo, estimates, events")
      ->check(one_of(interchange::table_names()))
      ->type_name("TABLE");
  command
      .add_flag("--tum{all}", options.tum,
                "Session: trajectories of the shaft and of each estimator, for evo; =NAME: one of them")
      ->check(CLI::Validator(problem_of_trajectory, ""))
      ->type_name("NAME");
  command
      .add_flag(
          "--mcap{none}", options.mcap,
          "Session: images, gyro, servo, labels and events for Foxglove; none (default) or zstd: compressed")
      ->check(CLI::IsMember({"none", "zstd"}))
      ->type_name("HOW");
}

}  // namespace

void add_export(CLI::App& root, ExportOptions& options) {
  CLI::App& command = *root.add_subcommand(
      "export", "Export a session, a model or the odometer for other programs and small boards");
  command
      .add_option("FILE", options.file,
                  "Session (.h5) or folder of sessions, model file (.onnx) or profile (.toml)")
      ->required();
  add_session_forms(command, options);
  add_model_forms(command, options);
  command
      .add_option("-o,--output", options.output,
                  "Folder to write to; of a session also - for standard output")
      ->type_name("DIR")
      ->default_str("the present one");
  add_json(command, options.json);
  command.footer(
      "Examples:\n"
      "  thermorig export session.h5 --npz --nf 3 --mcap -o exported\n"
      "  thermorig export session.h5 --csv=gyro -o - | head\n"
      "  thermorig export model.onnx --c-header --weights int8 -o firmware/src\n"
      "  thermorig export rig.toml --odometer -o firmware/src");
}

}  // namespace thermorig::app
