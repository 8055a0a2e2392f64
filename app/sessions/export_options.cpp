// SPDX-License-Identifier: MIT
#include <CLI/CLI.hpp>

#include "learning_options.h"
#include "rig_options.h"

namespace thermorig::app {

void add_export(CLI::App& root, ExportOptions& options) {
  CLI::App& command = *root.add_subcommand("export", "Export a model for small boards and other programs");
  command.add_option("MODEL", options.model, "Model file (.onnx)")->required();
  CLI::Option* c_header = command.add_flag("--c-header", options.c_header,
                                           "C99 sources for small boards: NAME.h, NAME.c and NAME_weights.h");
  command.add_option("--weights", options.weights, "Of the C sources: float32 or int8")
      ->check(CLI::IsMember({"float32", "int8"}))
      ->capture_default_str()
      ->needs(c_header);
  command.add_option("--name", options.name, "Prefix of the C sources' files and symbols")
      ->type_name("NAME")
      ->capture_default_str()
      ->needs(c_header);
  command.add_option("--batch", options.batch, "ONNX with a fixed batch of N, for engines that ask for one")
      ->check(CLI::Range(1, 65'536))
      ->type_name("N");
  command.add_option("-o,--output", options.output, "Folder to write to")
      ->type_name("DIR")
      ->default_str("the present one");
  add_json(command, options.json);
  command.footer("Example:\n  thermorig export model.onnx --c-header --weights int8 -o firmware/src");
}

}  // namespace thermorig::app
