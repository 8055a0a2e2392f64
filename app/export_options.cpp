// SPDX-License-Identifier: MIT
#include <CLI/CLI.hpp>

#include "learning_options.h"

namespace thermorig::app {

void add_export(CLI::App& root, ExportOptions& options) {
  CLI::App& command = *root.add_subcommand("export", "Export a model for other programs and small boards");
  command.add_option("MODEL", options.model, "Model file (.onnx)")->required();
  command.add_option("-o,--output", options.output, "Folder to write to")->type_name("DIR");
  command.add_flag("--json", options.json, "Print JSON on standard output, for programs");
}

}  // namespace thermorig::app
