// SPDX-License-Identifier: MIT
#include <CLI/CLI.hpp>

#include "learning_options.h"

namespace thermorig::app {

void add_evaluate(CLI::App& root, EvaluateOptions& options) {
  CLI::App& command =
      *root.add_subcommand("evaluate", "Evaluate a model on sessions, or run the study of the paper");
  command.add_option("PATH", options.paths, "Session files (.h5), or folders that hold them");
  command.add_option("-o,--output", options.output, "Folder of results")->type_name("DIR");
  command.add_flag("--json", options.json, "Print JSON on standard output, for programs");
}

}  // namespace thermorig::app
