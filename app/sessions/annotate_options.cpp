// SPDX-License-Identifier: MIT
#include <CLI/CLI.hpp>

#include "rig_options.h"
#include "session_options.h"

namespace thermorig::app {

void add_annotate(CLI::App& root, AnnotateOptions& options) {
  CLI::App& command = *root.add_subcommand("annotate", "Add notes or exclude frames");
  command.add_option("SESSION", options.file, "Session file (.h5); the whole file is written again")
      ->required();
  CLI::Option_group& kinds = *command.add_option_group("One of these");
  kinds.add_option("--note", options.note, "Add a note")->type_name("TEXT");
  kinds
      .add_option("--environment", options.environment,
                  "Correct the environment: the file moves there and gets the next free number")
      ->type_name("NAME");
  CLI::Option* exclude = kinds
                             .add_option("--exclude", options.exclude,
                                         "Exclude frames from A to B, in seconds since the start, or all")
                             ->type_name("A..B");
  kinds.add_flag("--undo", options.undo, "Undo the last annotation");
  kinds.require_option(1);
  command.add_option("--reason", options.reason, "Why the frames are excluded")
      ->type_name("TEXT")
      ->needs(exclude);
  add_json(command, options.json);
  command.footer(
      "Examples:\n"
      "  thermorig annotate session.h5 --note 'the window was open'\n"
      "  thermorig annotate session.h5 --exclude 12.5..14.0 --reason 'a hand'\n"
      "  thermorig annotate session.h5 --undo");
}

}  // namespace thermorig::app
