// SPDX-License-Identifier: MIT
#include <CLI/CLI.hpp>

#include "learning_options.h"

namespace thermorig::app {

void add_train(CLI::App& root, TrainOptions& options) {
  CLI::App& command = *root.add_subcommand("train", "Train the fusion network on sessions");
  command.add_option("PATH", options.paths, "Session files (.h5), or folders that hold them")->required();
  command.add_option("-o,--output", options.output, "Model file to write")
      ->type_name("FILE")
      ->default_str("model.onnx");
  command.add_flag("--json", options.json, "Print JSON on standard output, for programs");
}

}  // namespace thermorig::app
